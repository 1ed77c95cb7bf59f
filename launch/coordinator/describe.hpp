// What a scene consists of, for people.
#pragma once

#include <string>

#include "launch/coordinator/scene_file.hpp"

namespace tandem::launch {

// Bodies, joints, degrees of freedom, walls, spheres, material pairs and time steps as tables.
std::string describe(const SceneFile& file);

}  // namespace tandem::launch
