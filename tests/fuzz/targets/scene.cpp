// The text of a scene, with the strict parser and all checks that need no file.
#include <nlohmann/json.hpp>

#include "common/scene/columns.hpp"
#include "common/scene/document.hpp"
#include "common/scene/parse.hpp"
#include "tests/fuzz/targets/shipped.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "tests/unit/common/good_scene.hpp"

namespace tandem::fuzz {
namespace scene_part {

class SceneTarget : public Target {
 public:
  void run(std::span<const std::byte> input) override {
    const std::string text(text_of(input));
    const scene::Scene scene = scene::parse(text, "scene.json");
    scene::validate(scene, "scene.json");
    scene::warnings(scene);
    scene::body_columns(scene);
    scene::joint_columns(scene);
    // Writing and reading the scene must give the same, valid scene.
    const nlohmann::json document = scene::read_document(text, "scene.json");
    const std::string written = document.dump();
    expect(scene::read_document(written, "again") == document,
           "a scene that is written and read again is another one");
    try {
      scene::validate(scene::parse(written, "again"), "again");
    } catch (const std::exception& e) {
      throw Finding(std::string("a valid scene, written and read again, is refused: ") + e.what());
    }
  }
};

std::vector<Bytes> scenes(const std::filesystem::path&) {
  std::vector<Bytes> corpus{bytes_of(scene::test::good_scene_text)};
  for (const std::string_view text : shipped_scenes()) corpus.push_back(bytes_of(text));
  return corpus;
}

}  // namespace scene_part

TargetKind scene_target() {
  using namespace scene_part;
  return {.name = "scene", .text = true, .corpus = scenes, .make = make_target<SceneTarget>};
}

}  // namespace tandem::fuzz
