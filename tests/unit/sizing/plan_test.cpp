// The plan of a scene: what it says, and what it refuses.
#include "launch/sizing/plan.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

SceneFile shipped(const char* name) {
  return read_scene(std::string(TANDEM_SOURCE_DIR) + "/launch/scenes/" + name, {},
                    SettleOn{.settles = false});
}
bool says(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST(Plan, OfASmallSceneSaysThatOneGpuIsFaster) {
  const std::string text = plan(shipped("box_weight.json"), {true, 8, 0, 0});
  EXPECT_TRUE(says(text, "box_weight: 1,331 spheres on 8 GPUs")) << text;
  EXPECT_TRUE(says(text, "One GPU is faster")) << text;
  EXPECT_TRUE(says(text, "40,000 micro steps")) << text;
}

TEST(Plan, OfALargerBedSaysThatItDoesNotFit) {
  const SceneFile file = shipped("box_weight.json");
  EXPECT_TRUE(says(plan(file, {true, 2, 3e8, 0}), "  limit                 work\n"));
  EXPECT_TRUE(says(plan(file, {true, 1, 3e8, 0}), "memory: it does not fit"));
  EXPECT_TRUE(says(plan(file, {true, 1, 3e8, 140e9}), "  limit                 work\n"));
}

TEST(Plan, OfRanksUsesTheMemoryOfTheHost) {
  const std::string text = plan(shipped("chute.json"), {false, 4, 1e6, 8e9});
  EXPECT_TRUE(says(text, " of 2 GB\n")) << text;
  EXPECT_TRUE(says(text, "no rate of this contact law, precision or domain was measured")) << text;
}

TEST(Plan, RefusesASceneWithoutGrains) {
  EXPECT_THROW(plan(shipped("pendulum.json"), {true, 2, 0, 0}), Error);
}

}  // namespace
}  // namespace tandem::launch
