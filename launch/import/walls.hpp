// Collision shapes of a URDF model as walls of a scene.
#pragma once

#include "launch/import/bodies.hpp"
#include "launch/import/import.hpp"

namespace tandem::launch {

// `folder`: of the scene; mesh files are named relative to it.
void add_walls(const urdf::ModelInterface& model, const LinkFrames& frames, const ImportOptions& options,
               const std::filesystem::path& folder, nlohmann::ordered_json& dem,
               std::vector<std::string>& notes);

// Without particles there are no walls: shapes of links that are bodies become shapes of those for pictures,
// by <collision>, or by <visual> where a link has no other. Adds a note for each that is left out.
void add_graphics(const urdf::ModelInterface& model, const LinkFrames& frames, const ImportOptions& options,
                  const std::filesystem::path& folder, nlohmann::ordered_json& bodies,
                  std::vector<std::string>& notes);

}  // namespace tandem::launch
