// A liquid without a domain gets one around its walls, which follows the vessel.
#include "coordinator/scene/liquid_domain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/error_of.hpp"

namespace tandem::launch {
namespace liquid_domain_test {

namespace fs = std::filesystem;
using test::error_of;
using ::testing::Contains;
using ::testing::HasSubstr;

class LiquidDomain : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("tandem_liquid_domain_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    scene_ = nlohmann::json::parse(R"({"tandem": "1.1", "name": "mug", "end_time": 0.01,
      "sph": {"spacing": 0.02,
        "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001,
                     "fill": [{"type": "inside", "wall": "mug", "level": 0.07}]}],
        "walls": [{"name": "mug", "position": [0, 0, 0.06],
                   "shape": {"type": "box", "size": [0.1, 0.08, 0.12], "open": ["+z"]}}]}})");
  }
  void TearDown() override { fs::remove_all(folder_); }

  // The mug is on a body at this height [m].
  void put_on_body(double height) {
    scene_["mbd"] = nlohmann::json::parse(R"({"bodies": [
      {"name": "tray", "mass": 1, "inertia": [1e-3, 1e-3, 1e-3, 0, 0, 0], "position": [0, 0, 0]}],
      "joints": [{"name": "free", "type": "free", "child": "tray", "position": [0, 0, 0]}]})");
    scene_["mbd"]["bodies"][0]["position"] = {0, 0, height};
    scene_["sph"]["walls"][0]["body"] = "tray";
    scene_["sph"]["liquids"][0]["fill"][0]["level"] = height + 0.07;
  }
  SceneFile read() {
    std::ofstream(folder_ / "scene.json") << scene_.dump();
    return read_scene(folder_ / "scene.json", {}, std::nullopt);
  }

  fs::path folder_;
  nlohmann::json scene_;
};

TEST_F(LiquidDomain, SurroundsTheWallsByTheirLongestEdge) {
  const SceneFile file = read();
  const scene::Box& box = file.scene.sph->domain;
  EXPECT_TRUE(file.scene.sph->domain_is_given);
  for (int a = 0; a < 3; ++a) {
    const double half[] = {0.05, 0.04, 0.06}, middle = a == 2 ? 0.06 : 0;
    EXPECT_NEAR(box.min[a], middle - half[a] - 0.12, 0.002);
    EXPECT_NEAR(box.max[a], middle + half[a] + 0.12, 0.002);
  }
  EXPECT_FALSE(file.scene.sph->follows);
  EXPECT_THAT(file.notes, Contains(HasSubstr("since sph.domain gives none")));
  // The servers get it in the scene.
  EXPECT_TRUE(nlohmann::json::parse(file.text)["sph"]["domain"].contains("min"));
}

TEST_F(LiquidDomain, FollowsTheVessel) {
  put_on_body(5);
  const SceneFile file = read();
  ASSERT_TRUE(file.scene.sph->follows);
  EXPECT_EQ(file.scene.body_name(*file.scene.sph->follows), "tray");
  EXPECT_NEAR(file.scene.sph->domain.min.z, 5 - 0.12, 0.002);
}

TEST_F(LiquidDomain, StaysWherePlanesOfTheGroundAre) {
  put_on_body(1);
  scene_["sph"]["walls"].push_back(
      {{"name", "floor"}, {"shape", {{"type", "plane"}, {"point", {0, 0, 0}}, {"normal", {0, 0, 1}}}}});
  EXPECT_FALSE(read().scene.sph->follows);
}

TEST_F(LiquidDomain, IsRefusedWhereNothingEnds) {
  scene_["sph"]["walls"] = nlohmann::json::array();
  scene_["sph"]["liquids"][0]["fill"] = nlohmann::json::array();
  scene_["sph"]["inlets"] = nlohmann::json::parse(
      R"([{"name": "tap", "position": [0, 0, 0], "shape": {"type": "disc", "radius": 0.1}, "velocity": 1}])");
  EXPECT_THAT(error_of([&] { read(); }), HasSubstr("give sph.domain"));
}

TEST_F(LiquidDomain, NeedsBothCornersOrNone) {
  scene_["sph"]["domain"] = {{"min", {0, 0, 0}}};
  EXPECT_THAT(error_of([&] { read(); }), HasSubstr("sph.domain: one corner is given without the other"));
}

}  // namespace liquid_domain_test
}  // namespace tandem::launch
