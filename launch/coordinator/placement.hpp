// Fills that are placed before the start. Solvers receive them as particle files.
#pragma once

#include <filesystem>

#include "launch/coordinator/scene_file.hpp"

namespace tandem::launch {

// Replaces packings and fills from other runs by particle files, in the scene and in its text. The scene and
// its other files are complete. Throws Error{scene} where spheres do not fit, or a run has no such frame.
void place_fills(const std::filesystem::path& folder, SceneFile& file);

}  // namespace tandem::launch
