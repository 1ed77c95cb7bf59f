// What a scene consists of, for people.
#pragma once

#include <string>

#include "launch/coordinator/dry_run.hpp"

namespace tandem::launch {

// Bodies, joints, degrees of freedom, walls, meshes, spheres, material pairs and time steps as tables, then
// warnings and notes. What only solvers know is in it where they have been started: `started` may be null.
std::string describe(const SceneFile& file, const DryRun* started);

// "warning: ..." and "note: ..." in a line each, `indent` in front.
std::string remarks(const SceneFile& file, const DryRun* started, const std::string& indent = "");

}  // namespace tandem::launch
