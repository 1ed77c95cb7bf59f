// Names and places of what a scene has besides its bodies, and the direction of belts.
#include "coordinator/report/regions.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/scene/parse.hpp"

namespace tandem::launch {
namespace {

scene::Scene conveyor(const std::string& speed) {
  return scene::parse(R"({"tandem": "1.1", "name": "conveyor", "end_time": 1, "dem": {
    "materials": [{"name": "grain", "density": 2000, "young": 1e7, "poisson": 0.25}],
    "pairs": [{"a": "grain", "b": "grain", "restitution": 0.5, "friction": 0.4}],
    "particles": [{"name": "feed", "material": "grain", "radius": 0.01,
                   "fill": {"type": "inlet", "min": [0, 0, 1], "max": [0.2, 0.2, 1.2], "mass_rate": 1}}],
    "walls": [{"name": "belt", "shape": {"type": "box", "size": [2, 0.4, 0.02]}, "position": [1, 0, -0.01], "material": "grain",
               "surface_velocity": )" +
                          speed + R"(}],
    "sensors": [{"name": "end", "shape": {"type": "box", "size": [0.1, 0.4, 0.4]}, "position": [2, 0, 0.2]}],
    "outlets": [{"name": "below", "region": {"type": "box", "min": [-1, -1, -2], "max": [3, 1, -1]}}],
    "domain": {"min": [-1, -1, -2], "max": [3, 1, 2]}}})",
                      "conveyor.json");
}

TEST(Regions, HaveTheNamesAndPlacesOfTheScene) {
  const std::vector<Region> regions = regions_of(conveyor("[0.5, 0, 0]"));
  std::vector<std::string> words;
  for (const Region& region : regions) words.push_back(region.words);
  EXPECT_EQ(words,
            (std::vector<std::string>{"feed (inlet)", "below (outlet)", "end (sensor)", "belt (wall)"}));
  EXPECT_LT(norm(regions[0].at - Vec3d{0.1, 0.1, 1.1}), 1e-12);
  EXPECT_LT(norm(regions[2].at - Vec3d{2, 0, 0.2}), 1e-12);
  for (const std::size_t i : {0u, 1u, 2u}) EXPECT_EQ(regions[i].lines.size(), 12u);
  EXPECT_TRUE(regions[3].lines.empty()) << "walls are drawn themselves";
  double highest = -1e9;
  for (const auto& [a, b] : regions[2].lines) highest = std::max({highest, a.z, b.z});
  EXPECT_NEAR(highest, 0.4, 1e-12);
}

TEST(Regions, ArrowsOnABeltPointWhereItRuns) {
  for (const double side : {1.0, -1.0}) {
    const std::vector<Arrow> arrows =
        belt_arrows(conveyor(side > 0 ? "[0.5, 0, 0]" : "[-0.5, 0, 0]"), Frame{});
    ASSERT_EQ(arrows.size(), 3u);
    for (const Arrow& arrow : arrows) {
      EXPECT_LT(norm(normalized(arrow.to - arrow.from) - Vec3d{side, 0, 0}), 1e-12);
      EXPECT_NEAR(arrow.from.z, 0, 1e-12) << "on top";
      EXPECT_LT(norm(arrow.normal - Vec3d{0, 0, 1}), 1e-12);
      EXPECT_GT(arrow.from.x, 0);
      EXPECT_LT(arrow.to.x, 2);
    }
  }
}

TEST(Regions, AWallThatDoesNotRunHasNoArrow) {
  EXPECT_TRUE(
      belt_arrows(conveyor(R"({"direction": [1, 0, 0], "speed": {"type": "constant", "value": 0}})"), Frame{})
          .empty());
}

}  // namespace
}  // namespace tandem::launch
