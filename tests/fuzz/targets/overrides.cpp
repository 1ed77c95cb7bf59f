// Options of `tandem run` that replace values of a scene. The first line of an input is "END_TIME WINDOW
// SCHEME NAME VALUE ...", with '-' for none and values of parameters; the rest is the scene.
#include <cstdlib>
#include <sstream>

#include "common/error.hpp"
#include "common/scene/parse.hpp"
#include "common/utf8.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/shipped.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace overrides_part {

std::optional<double> override_of(const std::string& word) {
  if (word.empty() || word == "-") return {};
  return std::strtod(word.c_str(), nullptr);
}

class OverridesTarget : public Target {
 public:
  explicit OverridesTarget(const std::filesystem::path& folder) : file_(folder / "scene.json") {}

  void run(std::span<const std::byte> input) override {
    const std::string_view text = text_of(input);
    const std::size_t end = std::min(text.find('\n'), text.size());
    // The same order as in launch/main.cpp.
    if (!is_utf8(text.substr(0, end)))
      throw Error(ErrorCode::usage, "a word of the command line is not UTF-8");
    std::istringstream line{std::string(text.substr(0, end))};
    std::string end_time, window, scheme;
    line >> end_time >> window >> scheme;
    launch::Overrides overrides;
    overrides.end_time = override_of(end_time);
    overrides.window = override_of(window);
    if (!scheme.empty() && scheme != "-") overrides.scheme = scheme;
    for (std::string name, value; line >> name >> value;)
      overrides.set[name] = override_of(value).value_or(0.0);
    put(file_, input.subspan(std::min(end + 1, input.size())));
    const launch::SceneFile scene = launch::read_scene(file_, overrides);
    if (overrides.end_time)
      expect(scene.scene.end_time == *overrides.end_time, "--end-time is not what is run");
    if (overrides.window)
      expect(scene.scene.coupling.window == *overrides.window, "--window is not what is run");
    // The servers receive the text.
    try {
      scene::validate(scene::parse(scene.text, "again"), "again");
    } catch (const std::exception& e) {
      throw Finding(std::string("the servers refuse what the coordinator accepts: ") + e.what());
    }
  }

 private:
  std::filesystem::path file_;
};

std::vector<Bytes> overridden_scenes(const std::filesystem::path&) {
  std::vector<Bytes> corpus;
  const auto add = [&](const char* line, const char* scene) {
    corpus.push_back(bytes_of(line + std::string("\n") + std::string(shipped_scene(scene))));
  };
  for (const char* scene : {"dead_point", "bouncing", "chute", "four_bars"}) {
    add("- - -", scene);
    add("0.1 - -", scene);
  }
  add("0.1 0.02 -", "dead_point");
  add("- - mbd_first", "bouncing");
  std::string fall(shipped_scene("bouncing"));
  fall.insert(fall.find('{') + 1,
              R"json("parameters": {"turn": {"value": 3, "unit": "deg"}, "size": "=2*sin(turn)"},)json");
  corpus.push_back(bytes_of("- - - turn 5\n" + fall));
  return corpus;
}

}  // namespace overrides_part

TargetKind overrides_target() {
  using namespace overrides_part;
  return {
      .name = "overrides", .text = true, .corpus = overridden_scenes, .make = make_target<OverridesTarget>};
}

}  // namespace tandem::fuzz
