// What looks wrong in the sizes and surfaces of a scene, though it may be meant: wrong units, holes, meshes
// finer than spheres need, bodies that seem to touch. Nothing is changed because of it.
#pragma once

#include <nlohmann/json.hpp>

#include "launch/coordinator/scene_file.hpp"

namespace tandem::launch {

// Adds to `file.warnings` what probably spoils the run, and to `file.notes` what one may want to know before
// it. The scene and its meshes have been read.
void review_geometry(SceneFile& file);

// The facts of meshes as they stand in summary.json.
nlohmann::ordered_json to_json(const std::vector<ImportedMesh>& meshes);

}  // namespace tandem::launch
