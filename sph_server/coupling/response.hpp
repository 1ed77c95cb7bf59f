// How the liquid at the start resists a change of the velocity of each body: radiation damping and added
// mass, for the stability of the coupling (docs/coupling.md).
#pragma once

#include <vector>

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"
#include "sph_server/engine/liquid_engine.hpp"

namespace tandem::sph {

// Impulse on a body that the liquid gave until some times after a step of the velocity of the body by one, by
// rows, with the sign of a resistance [kg] [kg m/rad] [kg m] [kg m2/rad].
struct StepResponse {
  double dt = 0;                                // between two times [s]
  std::vector<std::array<double, 36>> impulse;  // at dt, 2 dt, ...
};

// Radiation, added mass and delay of the record that fit the impulses. gyration: radius of gyration of the
// body, which makes rotations comparable with displacements [m]. All zero where nothing resists.
protocol::BodyResponse fitted(const StepResponse& measured, double gyration);

// Measures by as many steps of dt [s] of the engine for each direction in which a body can move, from the
// state that was set, and sets that state again. body_of: of each wall of the engine.
std::vector<protocol::BodyResponse> measure_responses(LiquidEngine& engine, const LiquidState& start,
                                                      const std::vector<particles::BodyPose>& poses,
                                                      const std::vector<BodyId>& body_of,
                                                      const scene::Scene& scene, double sound_speed,
                                                      double dt, int steps);

}  // namespace tandem::sph
