// Natural frequencies and damping of a scene's machine.
#pragma once

#include <string>

#include "common/scene/model.hpp"

namespace tandem::mbd {

// A table of the modes by ascending frequency, and what they mean for the coupling; about the configuration
// and rates of the scene, which has a machine, or about the equilibrium near it. Throws Error{scene} where it
// does not stay as it is, or has no equilibrium.
std::string machine_modes(const scene::Scene& scene, bool as_given);

}  // namespace tandem::mbd
