// A scene file with all files that it refers to, read once by the coordinator; the servers receive it by the
// protocol.
#pragma once

#include "common/scene/model.hpp"
#include "launch/coordinator/options.hpp"
#include "launch/mesh_import/mesh_facts.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

struct ImportedMesh {
  std::string wall;  // of the wall
  std::string file;  // as written in the scene
  double scale = 1;  // applied [m per unit of the file]
  MeshFacts facts;   // in the frame of the wall's shape
};

struct SceneFile {
  std::string text;                         // JSON including the overrides: the servers get this scene
  std::string origin;                       // path of the file, for messages
  scene::Scene scene;                       // parsed and validated
  std::vector<std::string> warnings;        // problems that the user should see with the results
  std::vector<std::string> notes;           // useful information before a run
  std::vector<protocol::NamedMesh> meshes;  // of the walls with a mesh file
  std::vector<ImportedMesh> mesh_facts;     // of the same meshes, in the same order
  std::vector<protocol::NamedText> files;   // of the particle groups with a file
};

// Throws every error of the scene and of the files that it names.
SceneFile read_scene(const std::filesystem::path& path, const Overrides& overrides = {});

}  // namespace tandem::launch
