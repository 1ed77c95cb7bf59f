// An instant at which forces act: a state, and the motion of the links in it.
#pragma once

#include <vector>

#include "mbd_server/kinematics/kinematics.hpp"

namespace tandem::mbd {

struct Instant {
  const Model& model;
  const State& state;
  const std::vector<LinkMotion>& links;
};

// Sizes of forces and torques, for the scale of a machine's forces [N], [N m].
struct ForceSize {
  double force = 0, torque = 0;
};

}  // namespace tandem::mbd
