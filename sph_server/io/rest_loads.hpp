// Loads of the liquid at rest on the bodies, for the search for the equilibrium of their machine.
#pragma once

#include <map>
#include <vector>

#include "common/math/rotation.hpp"
#include "common/scene/model.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/io/body_walls.hpp"

namespace tandem::sph {

// On each body with walls but the ground: force, and torque about its centre of mass, axes of the world. The
// pressure on a wall is that of the nearest particle, hydrostatic from there; the vessel bears what the other
// walls leave of the weight. `walls` are those of `setup`, which have these poses.
std::map<BodyId, Wrench> loads_at_rest(const LiquidState& liquid, const std::vector<BodyWalls>& walls,
                                       const LiquidSetup& setup,
                                       const std::vector<particles::BodyPose>& poses, BodyId vessel);

}  // namespace tandem::sph
