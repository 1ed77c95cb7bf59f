#include "launch/coordinator/scene_file.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/scene/parse.hpp"

namespace tandem::launch {
namespace {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file || file.bad())
    throw Error(ErrorCode::scene, "cannot be read", path.string(), "give the path of a scene");
  return text.str();
}

// The text with the overrides in it. Text that is no JSON object stays as it is: the parser has the right
// words for it.
std::string with_overrides(const std::string& text, const Overrides& overrides) {
  if (!overrides.end_time && !overrides.scheme && !overrides.window) return text;
  auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!json.is_object()) return text;
  if (overrides.end_time) json["end_time"] = *overrides.end_time;
  if (overrides.scheme) json["coupling"]["scheme"] = *overrides.scheme;
  if (overrides.window) json["coupling"]["window"] = *overrides.window;
  return json.dump(2);
}

}  // namespace

SceneFile read_scene(const std::filesystem::path& path, const Overrides& overrides) {
  SceneFile file;
  file.origin = path.string();
  file.text = with_overrides(read_text(path), overrides);
  file.scene = scene::parse(file.text, file.origin);
  scene::validate(file.scene, file.origin);
  scene::validate_files(file.scene, file.origin, path.parent_path());
  return file;
}

}  // namespace tandem::launch
