// How the liquid at the start resists a step of the velocity of each body, for the stability of the coupling
// (docs/coupling.md).
#pragma once

#include <vector>

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"
#include "sph_server/engine/liquid_engine.hpp"

namespace tandem::sph {

// Measures by as many steps of dt [s] of the engine for each direction in which a body can move, from the
// state that was set, and sets that state again. body_of: of each wall of the engine.
std::vector<protocol::BodyResponse> measure_responses(LiquidEngine& engine, const LiquidState& start,
                                                      const std::vector<particles::BodyPose>& poses,
                                                      const std::vector<BodyId>& body_of,
                                                      const scene::Scene& scene, double sound_speed,
                                                      double dt, int steps);

// Rotates a response with its body from the orientation `before` to `now`.
void turn(const Mat3d& now, const Mat3d& before, protocol::BodyResponse& response);

}  // namespace tandem::sph
