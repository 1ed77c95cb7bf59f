// Reactions that rigid mechanics does not determine: with more hinges than it needs a door can be carried by any of them, and
// only their elasticity tells by which. The solver gives the smallest multipliers of all that move the machine in the same
// way; what another choice would change is found here.
#pragma once

#include <cstdint>
#include <vector>

#include "mbd_server/solve/kinematics.hpp"

namespace tandem::mbd {

// Bits of the components of a reaction: force x, y, z, torque x, y, z in world axes.
using Components = std::uint32_t;

// Components of the reaction of each joint that are not determined, at the kinematics `links` (joints of the scene).
// `null_space`: multipliers without effect there (equations x any number); idle equations are added.
std::vector<Components> undetermined_components(const Model& model, const std::vector<LinkMotion>& links,
                                                const Eigen::MatrixXd& null_space);

// force.x, torque.z and so on.
std::vector<const char*> component_names(Components components);

}  // namespace tandem::mbd
