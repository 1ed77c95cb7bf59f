// Describes the contents of a scene as text.
#pragma once

#include <string>

#include "coordinator/run/dry_run.hpp"

namespace tandem::launch {

// Bodies, joints, degrees of freedom, walls, meshes, spheres, material pairs and time steps as tables, then
// warnings and notes. Facts that only a solver can determine are included where solvers were started:
// `started` may be null.
std::string describe(const SceneFile& file, const DryRun* started);

// "warning: ..." and "note: ...", one per line, with `indent` in front.
std::string remarks(const SceneFile& file, const DryRun* started, const std::string& indent = "");

}  // namespace tandem::launch
