#include "launch/conform/scenes.hpp"

#include <nlohmann/json.hpp>

#include "common/error.hpp"

namespace tandem::conform {

const BuiltInScene& built_in_scene(const std::string& name) {
  for (const BuiltInScene& scene : built_in_scenes())
    if (scene.name == name) return scene;
  throw Error(ErrorCode::internal, "the judge has no scene '" + name + "'");
}

std::string with_simplest_contact(const std::string& text) {
  auto scene = nlohmann::ordered_json::parse(text);
  scene["dem"]["contact"] = "hooke";
  for (auto& material : scene["dem"]["materials"]) {
    material["friction"] = 0;
    // Contacts as long as those of Hertz's law in these scenes, some milliseconds [N/m].
    material["spring_stiffness"] = material["young"].get<double>() > 2e7 ? 2e5 : 1e4;
  }
  return scene.dump();
}

std::string with_end_time(const std::string& text, double end_time) {
  auto scene = nlohmann::ordered_json::parse(text);
  scene["end_time"] = end_time;
  return scene.dump();
}

}  // namespace tandem::conform
