// The paths in the text of a scene, which start at its folder: a copy elsewhere needs others.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/command_line.hpp"

namespace tandem::launch {

// Calls `use` with the name of each file that a valid scene has: meshes and particle files. `Json`: one of
// the classes of nlohmann, ordered or not.
template <class Json, class Use>
void for_each_file(Json& scene, const Use& use) {
  const auto each = [&](Json& part, const char* list, const char* inner) {
    if (!part.contains(list)) return;
    for (Json& item : part[list])
      if (item.contains(inner) && item[inner].contains("file")) use(item[inner]["file"]);
  };
  for (const char* part : {"dem", "sph"}) {
    if (!scene.contains(part)) continue;
    each(scene[part], "walls", "shape");
    each(scene[part], "particles", "fill");
  }
  if (!scene.contains("mbd")) return;
  for (Json& body : scene["mbd"]["bodies"]) each(body, "shapes", "shape");
  if (scene["mbd"].contains("contact")) each(scene["mbd"]["contact"], "ground", "shape");
}

// Makes the other paths absolute: folders of runs that fills begin with, and commands of servers.
template <class Json>
void make_other_paths_absolute(Json& scene, const std::filesystem::path& folder) {
  const auto absolute = [&folder](const std::string& path) {
    return std::filesystem::absolute(folder / path).lexically_normal().string();
  };
  if (scene.contains("dem") && scene["dem"].contains("particles"))
    for (Json& group : scene["dem"]["particles"])
      if (Json& fill = group["fill"]; fill.contains("folder"))
        fill["folder"] = absolute(fill["folder"].template get<std::string>());
  for (const char* part : {"mbd", "dem", "sph"}) {
    if (!scene.contains(part) || !scene[part].contains("server")) continue;
    std::vector<std::string> words =
        split_command(scene[part]["server"].template get<std::string>(), "server");
    if (words.front().find('/') == std::string::npos) continue;
    words.front() = absolute(words.front());
    scene[part]["server"] = join_command(words);
  }
}

}  // namespace tandem::launch
