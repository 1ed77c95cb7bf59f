#include "launch/import/base_scene.hpp"

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "common/scene/document.hpp"

namespace tandem::launch {

using Json = nlohmann::ordered_json;

Json base_scene(const ImportOptions& options, const std::string& name) {
  if (options.into.empty()) {
    return {{"tandem", "1.1"},
            {"name", name},
            {"description", "imported from " + options.model.filename().string()},
            {"end_time", 1.0},
            {"coupling", {{"window", 1e-3}}}};
  }
  const std::string text =
      read_input(options.into, {.largest = largest_text, .hint = "give the path of a scene"});
  scene::read_document(text, options.into.string());
  Json scene = Json::parse(text);
  if (!scene.is_object() || !scene.contains("dem"))
    throw Error(ErrorCode::scene, "is no scene with particles", options.into.string(),
                "walls need materials, particles and a domain: give a scene that has `dem`");
  return scene;
}

}  // namespace tandem::launch
