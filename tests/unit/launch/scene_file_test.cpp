#include "launch/coordinator/scene_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

// The message of read_scene() for a text, with and without an override.
class OverriddenScene : public testing::Test {
 protected:
  void SetUp() override {
    file_ = fs::temp_directory_path() / ("tandem_scene_" + std::to_string(getpid()) + ".json");
  }
  void TearDown() override { fs::remove(file_); }
  std::string refusal(const std::string& text, const Overrides& overrides) {
    std::ofstream(file_) << text;
    try {
      read_scene(file_, overrides);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::scene);
      return error.what();
    }
    return "";
  }
  // Refused with the same words, with and without an override.
  void expect_refused(const std::string& text, const std::string& words) {
    Overrides longer, finer;
    longer.end_time = 2;
    finer.window = 1e-3;
    const std::string plain = refusal(text, {});
    EXPECT_NE(plain.find(words), std::string::npos) << plain;
    EXPECT_EQ(refusal(text, longer), plain);
    EXPECT_EQ(refusal(text, finer), plain);
  }
  fs::path file_;
};

TEST_F(OverriddenScene, KeyGivenTwiceIsRefused) {
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": 1, "end_time": 3})", "is given twice");
}

// The limits belong to the laws of the particle solver, and are checked before a program starts.
TEST_F(OverriddenScene, MicroStepAboveTheLimitOfTheLawIsRefused) {
  std::ifstream base(std::string(TANDEM_SOURCE_DIR) + "/tests/system/scenes/hanging_box.json");
  auto json = nlohmann::json::parse(base);
  json["dem"]["micro_step"] = 0.999e-3;
  const std::string plain = refusal(json.dump(), {});
  EXPECT_NE(plain.find("dem.micro_step: the micro step of 0.000999 s is above the stable"), std::string::npos)
      << plain;
  EXPECT_NE(plain.find("0.4 of the Rayleigh time"), std::string::npos) << plain;
}

TEST_F(OverriddenScene, DeepNestingIsRefused) {
  expect_refused(std::string(100000, '['), "nested more than 64 deep");
}

TEST_F(OverriddenScene, CouplingThatIsNoObjectIsRefused) {
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": 1, "coupling": 3})",
                 "coupling: the value is 3");
}

TEST_F(OverriddenScene, ValuesOfAnotherTypeAreRefused) {
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": "x"})", "end_time: the value is \"x\"");
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": 1, "coupling": {"window": [1]}})",
                 "coupling.window: the value is [1]");
}

TEST_F(OverriddenScene, ChecksThatAreLeftOutMustBeRightToo) {
  expect_refused(R"({"tandem": "1.1", "name": "a", "end_time": 10, "checks": 5})", "checks: the value is 5");
}

TEST_F(OverriddenScene, TextThatIsNoJsonIsRefused) {
  expect_refused(R"({"tandem": "1.1", )", "line 1");
}

// An overridden value has the same bounds as one of the file.
TEST_F(OverriddenScene, OverrideOutOfBoundsIsRefused) {
  Overrides overrides;
  overrides.window = 1e-300;
  const std::string said = refusal(R"({"tandem": "1.1", "name": "a", "end_time": 1})", overrides);
  EXPECT_NE(said.find("coupling.window: the value is 1e-300"), std::string::npos) << said;
}

TEST(SceneFile, FoldersAndDevicesAreNoScenes) {
  const auto refusal = [](const char* path) -> std::string {
    try {
      read_scene(path, {});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("/tmp"), "/tmp: is a folder (give the path of a file)");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: is a device (give the path of a file)");
}

}  // namespace
}  // namespace tandem::launch
