// A scene file with everything it points to, read once by the coordinator; the servers get it through the
// protocol.
#pragma once

#include "common/scene/model.hpp"
#include "launch/coordinator/options.hpp"
#include "launch/mesh_import/mesh_facts.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

struct ImportedMesh {
  std::string wall;  // its name
  std::string file;  // as the scene has it
  double scale = 1;  // applied [m per unit of the file]
  MeshFacts facts;   // in the frame of the wall's shape
};

struct SceneFile {
  std::string text;    // JSON with the overrides written in, so that servers see the scene that runs
  std::string origin;  // path of the file, for messages
  scene::Scene scene;  // parsed and validated
  std::vector<std::string> warnings;        // that the user should see beside the results
  std::vector<std::string> notes;           // what one may want to know before a run
  std::vector<protocol::NamedMesh> meshes;  // of the walls with a mesh file
  std::vector<ImportedMesh> mesh_facts;     // of the same, in the same order
  std::vector<protocol::NamedText> files;   // of the particle groups with a file
};

// Every error of the scene and of the files that it names is thrown here.
SceneFile read_scene(const std::filesystem::path& path, const Overrides& overrides = {});

}  // namespace tandem::launch
