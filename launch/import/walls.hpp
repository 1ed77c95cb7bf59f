// Collision shapes of a URDF model as walls of a scene.
#pragma once

#include "launch/import/bodies.hpp"
#include "launch/import/import.hpp"

namespace tandem::launch {

// `folder`: of the scene, which mesh files are named relative to.
void add_walls(const urdf::ModelInterface& model, const LinkFrames& frames, const ImportOptions& options,
               const std::filesystem::path& folder, nlohmann::ordered_json& dem,
               std::vector<std::string>& notes);

// Says which shapes a scene without particles leaves out.
void note_shapes(const urdf::ModelInterface& model, std::vector<std::string>& notes);

}  // namespace tandem::launch
