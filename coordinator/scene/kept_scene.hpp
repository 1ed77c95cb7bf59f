// A copy of the scene in the folder of its run, with the files that it names: `tandem movie` finds it
// wherever the folder and the scene are by then.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {

// Writes FOLDER/scene/scene.json: the scene as it was given, with the overrides of the command line. Files of
// up to 64 MiB are next to it under their digest, those that are larger keep their absolute path. Throws
// Error{resource}.
void keep_scene(const SceneFile& file, const std::filesystem::path& folder);

// The scene of the run in `folder`: the copy, or where it was.
std::filesystem::path scene_of_run(const std::filesystem::path& folder, const nlohmann::json& summary);

}  // namespace tandem::launch
