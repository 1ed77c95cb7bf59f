// Fills that are placed before the start. Solvers receive them as particle files.
#pragma once

#include <filesystem>

#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {

// Replaces packings and fills from other runs by particle files, in the scene and in its text; where the
// scene says so, all spheres that move are those of a bed that has settled. The scene and its other files are
// complete. Throws Error{scene} where spheres do not fit or settle, or a run has no such frame.
void place_fills(const std::filesystem::path& folder, SceneFile& file, const SettleOn& on);

}  // namespace tandem::launch
