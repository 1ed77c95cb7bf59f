// A scene file with everything it points to, read once by the coordinator; the servers get it through the
// protocol.
#pragma once

#include "common/scene/model.hpp"
#include "launch/coordinator/options.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

struct SceneFile {
  std::string text;    // JSON with the overrides written in, so that servers see the scene that runs
  std::string origin;  // path of the file, for messages
  scene::Scene scene;  // parsed and validated
  std::vector<std::string> warnings;        // that the user should see beside the results
  std::vector<protocol::NamedMesh> meshes;  // of the walls with a mesh file
  std::vector<protocol::NamedText> files;   // of the particle groups with a file
};

// Every error of the scene and of the files that it names is thrown here.
SceneFile read_scene(const std::filesystem::path& path, const Overrides& overrides = {});

}  // namespace tandem::launch
