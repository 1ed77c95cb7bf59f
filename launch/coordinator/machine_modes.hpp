// The verb `modes`: natural frequencies and damping of a scene's machine.
#pragma once

#include <string>

#include "launch/coordinator/scene_file.hpp"

namespace tandem::launch {

// A table of the modes by ascending frequency, and what they mean for the coupling; about the configuration
// and rates of the scene, or about the equilibrium near it. Throws Error{usage} where the scene has no
// machine, Error{scene} where it does not stay as it is, or has no equilibrium.
std::string machine_modes(const SceneFile& file, bool as_given);

}  // namespace tandem::launch
