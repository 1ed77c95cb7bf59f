// Finds suspicious sizes and surfaces of a scene: wrong units, holes, meshes finer than the spheres need,
// bodies that seem to be in contact. They may be intended, and nothing is changed.
#pragma once

#include <nlohmann/json.hpp>

#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {

// Adds probable errors to `file.warnings`, and useful information to `file.notes`. The scene and its meshes
// have been read.
void review_geometry(SceneFile& file);

// The facts of meshes in the form of summary.json.
nlohmann::ordered_json to_json(const std::vector<ImportedMesh>& meshes);

}  // namespace tandem::launch
