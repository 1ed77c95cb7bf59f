#include "tests/unit/common/wrong_scene.hpp"

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/scene/parse.hpp"
#include "tests/unit/common/good_scene.hpp"

namespace tandem::scene::test {

std::string verdict(const std::string& text) {
  try {
    validate(parse(text, "scene.json"), "scene.json");
  } catch (const Error& error) {
    if (error.code() != ErrorCode::scene)
      return "code " + std::string(name(error.code())) + ": " + error.what();
    return error.what();
  }
  return "no error";
}

std::string verdict_on_patch(const std::string& patch) {
  return verdict(good_scene().patch(nlohmann::json::parse(patch)).dump());
}

TEST_P(WrongSceneTest, SaysWhatIsWrong) {
  const std::string prefix = "scene.json: ";
  EXPECT_EQ(verdict_on_patch(GetParam().patch), prefix + GetParam().message);
}

}  // namespace tandem::scene::test
