// Collision shapes of a URDF model as walls of a scene.
#pragma once

#include "launch/import/bodies.hpp"
#include "launch/import/import.hpp"

namespace tandem::launch {

// `folder`: of the scene; mesh files are named relative to it.
void add_walls(const urdf::ModelInterface& model, const LinkFrames& frames, const ImportOptions& options,
               const std::filesystem::path& folder, nlohmann::ordered_json& dem,
               std::vector<std::string>& notes);

// Notes the shapes that are left out of a scene without particles.
void note_shapes(const urdf::ModelInterface& model, std::vector<std::string>& notes);

}  // namespace tandem::launch
