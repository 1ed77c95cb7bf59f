// How a liquid starts: fills inside walls, friction of a pair, sensors, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "common/log.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/sensor_columns.hpp"
#include "sph_server/coupling/liquid_start.hpp"
#include "sph_server/coupling/make_solver.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// An open vat on the ground, 0.4 x 0.2 x 0.3 m, its floor at z = 0, filled up to the level of 0.16 m.
json vat() {
  return json::parse(R"({
    "tandem": "1.1", "name": "vat", "end_time": 0.1, "coupling": {"window": 0.002},
    "sph": {
      "spacing": 0.02,
      "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "artificial_viscosity": 0.1,
                   "fill": [{"type": "inside", "wall": "vat", "level": 0.16}]}],
      "walls": [{"name": "vat", "position": [0, 0, 0.15],
                 "shape": {"type": "box", "size": [0.4, 0.2, 0.3], "open": ["+z"]}}],
      "domain": {"min": [-0.5, -0.5, -0.2], "max": [0.5, 0.5, 0.6]}
    }
  })");
}
json& fill_of(json& scene) {
  return scene["sph"]["liquids"][0]["fill"];
}
json box_wall(const char* name, Vec3d position, Vec3d size, std::vector<std::string> open = {}) {
  return {{"name", name},
          {"position", {position.x, position.y, position.z}},
          {"shape", {{"type", "box"}, {"size", {size.x, size.y, size.z}}, {"open", open}}}};
}
const std::vector<std::string> across{"+y", "-y"};  // faces of a wall from one side of the vat to the other

sph::LiquidState particles(const json& scene) {
  const scene::Scene parsed = scene::parse(scene.dump(), "vat.json");
  scene::validate(parsed, "vat.json");
  return sph::start_of_liquid(parsed, {});
}
std::string refusal(const json& scene) {
  return error_of([&] { particles(scene); });
}

void expect_start(const char* what, double expected, double measured, double tolerance) {
  std::printf("%s: expected %.8g, measured %.8g, tolerance %.3g\n", what, expected, measured, tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

TEST(LiquidStart, TheInsideOfAWallIsFilledUpToALevelOrByAVolume) {
  const sph::LiquidState by_level = particles(vat());
  expect_start("particles below the level", 20 * 10 * 8, static_cast<double>(by_level.size()), 0);
  json scene = vat();
  fill_of(scene)[0].erase("level");
  fill_of(scene)[0]["volume"] = 0.4 * 0.2 * 0.16;
  const sph::LiquidState by_volume = particles(scene);
  ASSERT_EQ(by_volume.size(), by_level.size());
  double apart = 0;
  for (const Vec3d& x : by_volume.position) {
    double nearest = 1;
    for (const Vec3d& y : by_level.position) nearest = std::min(nearest, norm(x - y));
    apart = std::max(apart, nearest);
  }
  expect_start("largest distance of a particle filled by volume [m]", 0, apart, 1e-12);
  fill_of(scene)[0].erase("volume");
  fill_of(scene)[0]["mass"] = 1000 * 0.4 * 0.2 * 0.16;
  EXPECT_TRUE(particles(scene).position == by_volume.position);
  fill_of(scene)[0]["mass"] = 40;
  EXPECT_EQ(
      refusal(scene),
      "scene: sph.liquids[0].fill[0]: a mass of 40 kg and so a volume of 0.04 m3 in a region of 0.024 m3 "
      "(give a volume above 0 and of at most that of the region)");
  fill_of(scene)[0].erase("mass");
  // A box of the same size is the same liquid.
  fill_of(scene)[0] = {{"type", "box"}, {"min", {-0.2, -0.1, 0}}, {"max", {0.2, 0.1, 0.16}}};
  const sph::LiquidState box = particles(scene);
  ASSERT_EQ(box.size(), by_level.size());
  double sum = 0, of_box = 0;
  for (std::size_t i = 0; i < box.size(); ++i) {
    sum += by_level.compression[i];
    of_box += box.compression[i];
  }
  expect_start("sum of the compressions", of_box, sum, 1e-9 * of_box);
}

TEST(LiquidStart, TheLevelIsAgainstGravityFromTheOrigin) {
  json scene = vat();
  scene["sph"]["walls"][0]["position"][2] = 0.25;
  fill_of(scene)[0]["level"] = 0.26;
  expect_start("particles in a vat that is 0.1 m higher", 1600, static_cast<double>(particles(scene).size()),
               0);
}

TEST(LiquidStart, AClosedWallInTheLiquidIsLeftOut) {
  json scene = vat();
  scene["sph"]["walls"].push_back(box_wall("block", {0, 0, 0.06}, {0.08, 0.08, 0.04}));
  const sph::LiquidState state = particles(scene);
  expect_start("particles beside a block of 32", 1600 - 32, static_cast<double>(state.size()), 0);
  for (const Vec3d& x : state.position)
    EXPECT_FALSE(std::fabs(x.x) < 0.04 && std::fabs(x.y) < 0.04 && std::fabs(x.z - 0.06) < 0.02);
  // By volume the block raises the level.
  fill_of(scene)[0].erase("level");
  fill_of(scene)[0]["volume"] = 0.4 * 0.2 * 0.16;
  const scene::Scene parsed = scene::parse(scene.dump(), "vat.json");
  expect_start("depth by volume [m]", 0.16 + 32 * std::pow(0.02, 3) / (0.4 * 0.2),
               sph::insides_of(parsed, {}).at(0).depth, 1e-9);
}

// A wall that stands on the floor or at a side of the filled one, all of it in the liquid or not.
TEST(LiquidStart, AClosedWallMayStandOnTheFloorOfTheLiquid) {
  const struct {
    const char* where;
    Vec3d position, size;
    double particles;  // in it
  } blocks[] = {{"in the middle", {0, 0, 0.04}, {0.08, 0.08, 0.08}, 64},
                {"below the floor by rounding", {0, 0, 0.04 - 1e-10}, {0.08, 0.08, 0.08}, 64},
                {"at a side", {0.16, 0, 0.04}, {0.08, 0.08, 0.08}, 64},
                {"in a corner", {0.16, 0.06, 0.04}, {0.08, 0.08, 0.08}, 64},
                {"from side to side", {0, 0, 0.04}, {0.08, 0.2, 0.08}, 160},
                {"out of the liquid", {0, 0, 0.1}, {0.08, 0.08, 0.2}, 128}};
  for (const auto& block : blocks) {
    json scene = vat();
    scene["sph"]["walls"].push_back(box_wall("block", block.position, block.size));
    const sph::LiquidState state = particles(scene);
    expect_start(block.where, 1600 - block.particles, static_cast<double>(state.size()), 0);
    for (const Vec3d& x : state.position)
      EXPECT_FALSE(std::fabs(x.x - block.position.x) < 0.5 * block.size.x &&
                   std::fabs(x.y - block.position.y) < 0.5 * block.size.y && x.z < 0.5 * block.size.z);
  }
}

TEST(LiquidStart, WallsInTheLiquidMayPassThroughEachOther) {
  json scene = vat();
  // Two blades that cross have 2 x 2 x 4 particles in common. Their ends are not in one plane.
  scene["sph"]["walls"].push_back(box_wall("blade", {0, 0, 0.08}, {0.16, 0.04, 0.08}));
  scene["sph"]["walls"].push_back(box_wall("other", {0, 0, 0.08}, {0.04, 0.12, 0.0802}));
  const double taken = 8 * 2 * 4 + 2 * 6 * 4 - 2 * 2 * 4;
  expect_start("particles beside the blades", 1600 - taken, static_cast<double>(particles(scene).size()), 0);
  fill_of(scene)[0].erase("level");
  fill_of(scene)[0]["volume"] = (1600 - taken) * 8e-6;
  const scene::Scene parsed = scene::parse(scene.dump(), "vat.json");
  // 0.1 mm of the other blade at both ends are not in the particles.
  expect_start("depth by volume [m]", 0.16 + 0.04 * 0.12 * 2e-4 / (0.4 * 0.2),
               sph::insides_of(parsed, {}).at(0).depth, 1e-6);
}

// The lattice follows the axes of the wall, so that a vat that is turned, with gravity or about it, starts as
// before.
TEST(LiquidStart, TurnsWithTheFilledWall) {
  const sph::LiquidState level = particles(vat());
  for (const Quat& q : {Quat{0.3, -0.5, 0.7, 0.2}.normalized(), Quat{0.95, 0, 0, 0.3}.normalized()}) {
    json scene = vat();
    const Vec3d gravity = q.rotate({0, 0, -9.81}), at = q.rotate({0, 0, 0.15});
    scene["gravity"] = {gravity.x, gravity.y, gravity.z};
    scene["sph"]["walls"][0]["position"] = {at.x, at.y, at.z};
    scene["sph"]["walls"][0]["orientation"] = {q.w, q.x, q.y, q.z};
    scene["sph"]["domain"] = {{"min", {-1, -1, -1}}, {"max", {1, 1, 1}}};
    const sph::LiquidState turned = particles(scene);
    ASSERT_EQ(turned.size(), level.size());
    double apart = 0;
    for (const Vec3d& x : turned.position) {
      double nearest = 1;
      for (const Vec3d& y : level.position) nearest = std::min(nearest, norm(x - q.rotate(y)));
      apart = std::max(apart, nearest);
    }
    expect_start("largest distance from a particle of the vat that is not turned [m]", 0, apart, 1e-12);
  }
}

TEST(LiquidStart, AWallThatIsOpenHasLiquidOnBothSides) {
  json scene = vat();
  const auto beside = [&](const json& wall) {
    scene["sph"]["walls"][1] = wall;
    return static_cast<double>(particles(scene).size());
  };
  expect_start("particles on both sides of a sheet", 1600,
               beside(box_wall("sheet", {0, 0.03, 0.08}, {0.16, 0.06, 0.08}, {"+y", "+x", "-x", "+z", "-z"})),
               0);
  expect_start("in and around a cup that is open below the level", 1600,
               beside(box_wall("cup", {0, 0, 0.08}, {0.08, 0.08, 0.08}, {"+z"})), 0);
  expect_start("around a cup that is open above the level", 1600 - 80,
               beside(box_wall("cup", {0, 0, 0.14}, {0.08, 0.08, 0.16}, {"+z"})), 0);
  expect_start("around a block whose open face the floor closes", 1600 - 64,
               beside(box_wall("block", {0, 0, 0.04}, {0.08, 0.08, 0.08}, {"-z"})), 0);
}

TEST(LiquidStart, RefusesAnInletWithLiquidOnBothSides) {
  json scene = vat();
  scene["sph"]["inlets"] = {{{"name", "pipe"},
                             {"position", {0, 0, 0.06}},
                             {"shape", {{"type", "rectangle"}, {"size", {0.04, 0.04}}}},
                             {"velocity", 0.5}}};
  EXPECT_EQ(
      refusal(scene),
      "scene: sph.inlets[0]: the inlet 'pipe' has liquid on both sides, at [-0.01, -0.01, 0.06] m (put it "
      "on a wall of the vessel or of a nozzle, a solid in the liquid, or above the level)");
  scene["sph"]["inlets"][0]["position"][2] = 0;
  EXPECT_EQ(refusal(scene), "no error") << "on the floor";
  scene["sph"]["inlets"][0]["position"][2] = 0.2;
  EXPECT_EQ(refusal(scene), "no error") << "above the liquid";
  scene["sph"]["inlets"][0]["position"][2] = 0.06;
  scene["sph"]["walls"].push_back(box_wall("housing", {0, 0, 0.04}, {0.08, 0.08, 0.04}));
  EXPECT_EQ(refusal(scene), "no error") << "on a solid in the liquid";
}

TEST(LiquidStart, RefusesALevelCloseAboveAShelf) {
  json scene = vat();
  fill_of(scene)[0]["level"] = 0.111;
  scene["sph"]["walls"].push_back(box_wall("shelf", {-0.1, 0, 0.1}, {0.2, 0.2, 0.02}));
  EXPECT_THAT(refusal(scene), HasSubstr("deep over a wall at ("));
  fill_of(scene)[0]["level"] = 0.13;
  EXPECT_EQ(refusal(scene), "no error") << "a spacing above it";
}

TEST(LiquidStart, RefusesWallsThatLieOnEachOtherInTheLiquid) {
  json tank = vat();
  tank["mbd"]["bodies"] = {
      {{"name", "tank"}, {"mass", 5}, {"inertia", {1, 1, 1}}, {"position", {0, 0, 0.15}}}};
  tank["sph"]["walls"][0]["body"] = "tank";
  tank["sph"]["walls"][0].erase("position");
  const auto beside = [&](const json& wall) {
    json scene = tank;
    scene["sph"]["walls"].push_back(wall);
    return refusal(scene);
  };
  EXPECT_EQ(beside(box_wall("plate", {0, 0, -0.05}, {0.8, 0.8, 0.1})),
            "scene: sph.walls: wall 'vat' of 'tank' and wall 'plate' of 'ground' lie on each other at "
            "[-0.193333, -0.0916667, "
            "0] m, where the liquid sees them: both would act on it (leave one of them out there, as by "
            "'open' faces "
            "of a box or a cylinder, or put the one that the liquid touches a hundredth of a spacing in "
            "front of the "
            "other)");
  const json plane = {{"name", "plate"},
                      {"shape", {{"type", "plane"}, {"normal", {0, 0, 1}}, {"point", {0, 0, 0}}}}};
  EXPECT_THAT(beside(plane), HasSubstr("lie on each other")) << "a plane";
  EXPECT_THAT(beside(box_wall("plate", {0.5, 0, -0.05}, {0.8, 0.8, 0.1})), HasSubstr("lie on each other"))
      << "below a part of it";
  EXPECT_THAT(beside(box_wall("other", {0.3, 0, 0.15}, {0.2, 0.2, 0.3}, {"+z"})),
              HasSubstr("lie on each other"))
      << "side by side";
  EXPECT_EQ(beside(box_wall("plate", {0, 0, -0.0502}, {0.8, 0.8, 0.1})), "no error")
      << "a hundredth of a spacing below";
  EXPECT_EQ(beside(box_wall("plate", {0.05, 0, 0.15}, {0.003, 0.2, 0.3})), "no error")
      << "a thin plate from one side to the other hides where its edge is";
  // Coplanar faces that meet at edges, and those that overlap where no liquid is.
  json scene = vat();
  scene["sph"]["walls"].push_back(box_wall("rim", {0, 0, 0.35}, {0.4, 0.2, 0.1}, {"+z", "-z"}));
  EXPECT_EQ(refusal(scene), "no error");
  scene["sph"]["walls"][1] = box_wall("rim", {0, 0, 0.35}, {0.4, 0.2, 0.2}, {"+z", "-z"});
  EXPECT_EQ(refusal(scene), "no error");
  scene["sph"]["walls"][1] = box_wall("rim", {0, 0, 0.25}, {0.4, 0.2, 0.3}, {"+z", "-z"});
  EXPECT_THAT(refusal(scene), HasSubstr("lie on each other"));
  scene["sph"]["walls"][1] = box_wall("block", {0.16, 0.06, 0.1}, {0.08, 0.08, 0.2});
  EXPECT_EQ(refusal(scene), "no error") << "the sides of the block hide the faces in the corner";
}

TEST(LiquidStart, RefusesFillsThatAreNotInTheWall) {
  json scene = vat();
  fill_of(scene)[0]["level"] = 0.35;
  EXPECT_EQ(
      refusal(scene),
      "scene: sph.liquids[0].fill[0]: the level of 0.35 m is not in wall 'vat', which is from 0 to 0.3 m "
      "against gravity (give a level between them)");
  fill_of(scene)[0].erase("level");
  fill_of(scene)[0]["volume"] = 1;
  EXPECT_EQ(
      refusal(scene),
      "scene: sph.liquids[0].fill[0]: a volume of 1 m3 in a region of 0.024 m3 (give a volume above 0 and "
      "of at most that of the region)");
  scene = vat();
  scene["sph"]["walls"].push_back(box_wall("post", {0, 0, 0.05}, {0.04, 0.04, 0.2}));
  EXPECT_EQ(refusal(scene),
            "scene: sph.liquids[0].fill[0]: wall 'post' passes through wall 'vat' below the level: [-0.02, "
            "-0.0115152, -0.00151515] m is outside of it (let 'post' end at 'vat', or fill boxes)");
  // A post through the floor and the level, and a bar through both sides.
  for (const json& wall :
       {box_wall("post", {0, 0, 0.1}, {0.04, 0.04, 0.4}), box_wall("post", {0, 0, 0.1}, {0.5, 0.04, 0.04})}) {
    scene["sph"]["walls"][1] = wall;
    EXPECT_THAT(refusal(scene), HasSubstr("wall 'post' passes through wall 'vat' below the level"));
  }
  scene["sph"]["walls"][1] = box_wall("post", {0, 0, 0.15}, {0.4, 0.2, 0.3}, {"+z"});
  EXPECT_EQ(
      refusal(scene),
      "scene: sph.liquids[0].fill[0]: the closed walls in wall 'vat' leave no room for the liquid (leave "
      "out those that are the same as the wall, or fill boxes)");
  scene = vat();
  fill_of(scene).push_back({{"type", "box"}, {"min", {0, 0, 0.1}}, {"max", {0.1, 0.1, 0.2}}});
  EXPECT_THAT(refusal(scene), HasSubstr("sph.liquids[0].fill[0]: another fill is in it as well, at"));
}

TEST(LiquidStart, WarnsOfAFaceThatIsOpenBelowTheLevel) {
  const auto warnings = [](const json& scene) {
    return sph::prepare_start(scene::parse(scene.dump(), "vat.json"), {}).warnings;
  };
  json scene = vat();
  EXPECT_TRUE(warnings(scene).empty()) << "open above the level";
  json& vat = scene["sph"]["walls"][0];
  vat["shape"]["open"] = {"+z", "+x"};
  ASSERT_EQ(warnings(scene).size(), 1u);
  EXPECT_THAT(warnings(scene)[0],
              HasSubstr("sph.liquids[0].fill[0]: wall 'vat' is open at +x below the level"));
  // A gate, which ends above the level, closes it.
  scene["sph"]["walls"].push_back(box_wall("gate", {0.25, 0, 0.1}, {0.1, 0.2, 0.2}));
  EXPECT_TRUE(warnings(scene).empty());
  scene["sph"]["walls"][1] = box_wall("gate", {0.25, 0, 0.05}, {0.1, 0.2, 0.1});
  EXPECT_THAT(warnings(scene),
              ElementsAre(HasSubstr("wall 'vat' is open at +x"),
                          HasSubstr("wall 'gate' of 'ground' has sharp edges in the liquid")))
      << "above the gate";
}

TEST(LiquidStart, RefusesABoxThroughWhichAWallPasses) {
  json scene = vat();
  fill_of(scene)[0] = {{"type", "box"}, {"min", {-0.2, -0.1, 0}}, {"max", {0.26, 0.1, 0.16}}};
  EXPECT_THAT(refusal(scene),
              HasSubstr("sph.liquids[0].fill[0]: wall 'vat' passes through the box, between"));
  // A sheet between two boxes has liquid on both sides.
  scene = vat();
  json sheet = box_wall("sheet", {0, 0, 0.15}, {0.1, 0.2, 0.3});
  sheet["shape"]["open"] = {"-x", "+y", "-y", "+z", "-z"};  // the face at x = 0 is left
  sheet["position"][0] = -0.05;
  scene["sph"]["walls"].push_back(sheet);
  fill_of(scene) = json::array({{{"type", "box"}, {"min", {-0.2, -0.1, 0}}, {"max", {0, 0.1, 0.16}}},
                                {{"type", "box"}, {"min", {0, -0.1, 0}}, {"max", {0.2, 0.1, 0.16}}}});
  EXPECT_EQ(refusal(scene), "no error");
}

// Heights of the surface above the floor by the pressure at the start, of the sites of boxes for which
// is_meant(x) holds.
template <class IsMeant>
std::vector<double> surfaces(const json& scene, IsMeant is_meant) {
  const scene::Scene parsed = scene::parse(scene.dump(), "vat.json");
  scene::validate(parsed, "vat.json");
  const sph::LiquidStart start = sph::prepare_start(parsed, {});
  std::vector<double> heights;
  for (std::size_t i = 0; i < start.sites.position.size(); ++i)
    if (const Vec3d x = start.sites.position[i]; is_meant(x)) heights.push_back(x.z + start.sites.above[i]);
  return heights;
}
json filled_box(Vec3d min, Vec3d max) {
  return {{"type", "box"}, {"min", {min.x, min.y, min.z}}, {"max", {max.x, max.y, max.z}}};
}
const auto everywhere = [](Vec3d) { return true; };

TEST(LiquidStart, BoxesBelowABodyHaveThePressureOfTheLiquidBeside) {
  json scene = vat();
  scene["sph"]["walls"].push_back(box_wall("block", {0, 0, 0.06}, {0.08, 0.08, 0.04}));
  const sph::LiquidState inside = particles(scene);
  fill_of(scene) = {filled_box({-0.2, -0.1, 0}, {-0.04, 0.1, 0.16}),
                    filled_box({0.04, -0.1, 0}, {0.2, 0.1, 0.16}),
                    filled_box({-0.04, -0.1, 0}, {0.04, -0.04, 0.16}),
                    filled_box({-0.04, 0.04, 0}, {0.04, 0.1, 0.16}),
                    filled_box({-0.04, -0.04, 0}, {0.04, 0.04, 0.04}),
                    filled_box({-0.04, -0.04, 0.08}, {0.04, 0.04, 0.16})};
  const sph::LiquidState boxes = particles(scene);
  ASSERT_EQ(boxes.size(), inside.size());
  double apart = 0, deepest = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t k = 0; k < inside.size(); ++k)
      if (norm(boxes.position[i] - inside.position[k]) < 0.01) {
        apart = std::max(apart, std::fabs(boxes.compression[i] - inside.compression[k]));
        deepest = std::max(deepest, inside.compression[k]);
      }
  expect_start("largest difference of a compression from that of the inside", 0, apart, 1e-9 * deepest);
  for (const double height : surfaces(scene, everywhere)) EXPECT_NEAR(height, 0.16, 1e-12);
  // A body that covers the liquid, its underside 0.2 spacings above the box below.
  scene = vat();
  scene["sph"]["walls"].push_back(box_wall("float", {0, 0, 0.15}, {0.08, 0.2, 0.092}, across));
  fill_of(scene) = {filled_box({-0.2, -0.1, 0}, {-0.04, 0.1, 0.16}),
                    filled_box({0.04, -0.1, 0}, {0.2, 0.1, 0.16}),
                    filled_box({-0.04, -0.1, 0}, {0.04, 0.1, 0.1})};
  for (const double height : surfaces(scene, everywhere)) EXPECT_NEAR(height, 0.16, 1e-12);
  // Where the liquid can rise a spacing, it is not covered.
  scene["sph"]["walls"][1] = box_wall("float", {0, 0, 0.18}, {0.08, 0.2, 0.12}, across);
  const auto below = [](Vec3d x) { return std::fabs(x.x) < 0.04; };
  for (const double height : surfaces(scene, below)) EXPECT_NEAR(height, 0.1, 1e-12);
  // Liquid in a domain that repeats is connected through its ends.
  scene = vat();
  scene["sph"]["walls"] = {box_wall("float", {-0.15, 0, 0.15}, {0.1, 0.3, 0.1})};
  scene["sph"]["domain"] = {{"min", {-0.2, -0.1, -0.2}}, {"max", {0.2, 0.1, 0.6}}, {"periodic", {"x", "y"}}};
  fill_of(scene) = {filled_box({-0.2, -0.1, 0}, {-0.1, 0.1, 0.1}),
                    filled_box({0.16, -0.1, 0}, {0.2, 0.1, 0.16})};
  for (const double height : surfaces(scene, everywhere)) EXPECT_NEAR(height, 0.16, 1e-12);
}

// A U-tube: the block in the middle leaves a channel of two spacings at the floor.
TEST(LiquidStart, PressureOfCoveredLiquidGoesFromOneSurfaceToTheOther) {
  json scene = vat();
  scene["sph"]["walls"].push_back(box_wall("block", {0, 0, 0.17}, {0.2, 0.2, 0.26}, {"+y", "-y", "+z"}));
  fill_of(scene) = {filled_box({-0.2, -0.1, 0}, {-0.1, 0.1, 0.2}),
                    filled_box({-0.1, -0.1, 0}, {0.1, 0.1, 0.04}),
                    filled_box({0.1, -0.1, 0}, {0.2, 0.1, 0.1})};
  double worst = 0;
  for (int column = 0; column < 10; ++column) {
    const auto here = [&](Vec3d x) { return std::fabs(x.x - (-0.09 + 0.02 * column)) < 0.001; };
    for (const double height : surfaces(scene, here))
      worst = std::max(worst, std::fabs(height - (0.2 - 0.1 * (column + 1) / 11)));
  }
  expect_start("largest error of a surface above the channel [m]", 0, worst, 1e-9);
  // A wall in the channel separates the liquids: each has its own surface.
  scene["sph"]["walls"].push_back(
      box_wall("gate", {-0.05, 0, 0.1}, {0.1, 0.2, 0.2}, {"-x", "+y", "-y", "+z", "-z"}));
  fill_of(scene)[1]["max"][0] = 0;
  fill_of(scene).push_back(filled_box({0, -0.1, 0}, {0.1, 0.1, 0.04}));
  for (const double height : surfaces(scene, [](Vec3d x) { return x.x < 0; }))
    EXPECT_NEAR(height, 0.2, 1e-12);
  for (const double height : surfaces(scene, [](Vec3d x) { return x.x > 0; }))
    EXPECT_NEAR(height, 0.1, 1e-12);
}

TEST(LiquidStart, AFullChamberHasThePressureOfItsHighestPoint) {
  json scene = vat();
  scene["sph"]["walls"][0]["shape"].erase("open");
  scene["sph"]["walls"].push_back(
      box_wall("block", {0.1, 0, 0.25}, {0.2, 0.2, 0.1}, {"+x", "+y", "-y", "+z"}));
  fill_of(scene) = {filled_box({-0.2, -0.1, 0}, {0, 0.1, 0.3}), filled_box({0, -0.1, 0}, {0.2, 0.1, 0.2})};
  for (const double height : surfaces(scene, everywhere)) EXPECT_NEAR(height, 0.3, 1e-12);
}

TEST(LiquidStart, RefusesAFillThatIsThinnerThanASpacing) {
  json scene = vat();
  fill_of(scene)[0]["level"] = 0.001;
  EXPECT_EQ(
      refusal(scene),
      "scene: sph.liquids[0].fill[0]: the liquid is 0.001 m deep there, less than sph.spacing of 0.02 m "
      "(give a tenth of the depth as the spacing, or more liquid)");
  fill_of(scene)[0]["level"] = 0.02;
  EXPECT_EQ(refusal(scene), "no error");
}

TEST(LiquidStart, RefusesAPeriodInWhichParticlesSeeOthersTwice) {
  json scene = vat();
  fill_of(scene)[0] = {{"type", "box"}, {"min", {-0.1, -0.1, 0.1}}, {"max", {0.1, 0.1, 0.16}}};
  scene["sph"]["walls"] = json::array();
  scene["sph"]["domain"] = {{"min", {-0.5, -0.1, -0.2}}, {"max", {0.5, 0.1, 0.6}}, {"periodic", {"y"}}};
  EXPECT_EQ(refusal(scene), "no error") << "10 spacings, and 9.9 are enough";
  fill_of(scene)[0]["min"][1] = -0.06;
  fill_of(scene)[0]["max"][1] = 0.06;
  scene["sph"]["domain"]["min"][1] = -0.06;
  scene["sph"]["domain"]["max"][1] = 0.06;
  EXPECT_EQ(
      refusal(scene),
      "scene: sph.domain.periodic: the domain is 0.12 m long along its periodic axis y, which is 6 times "
      "sph.spacing, and a particle must not see another one twice (give it 0.198 m or more, or a spacing "
      "of 0.0121 m or less; of a slice of a liquid that is thinner, walls with free_slip are the sides)");
}

TEST(LiquidStart, RefusesAMeshWithATriangleTwice) {
  json scene = vat();
  scene["sph"]["walls"].push_back({{"name", "sheet"}, {"shape", {{"type", "mesh"}, {"file", "sheet.stl"}}}});
  const scene::Scene parsed = scene::parse(scene.dump(), "vat.json");
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0.2}, {0.1, 0, 0.2}, {0, 0.1, 0.2}, {0.1, 0.1, 0.2}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  const auto refused = [&] { return error_of([&] { sph::prepare_start(parsed, {{"sheet", mesh}}); }); };
  EXPECT_EQ(refused(), "no error");
  mesh.triangles.push_back({3, 1, 2});  // facing the other way
  EXPECT_EQ(refused(),
            "scene: sph.walls: 1 of 3 triangles of wall 'sheet' are there twice, one of them at [0.0666667, "
            "0.0666667, 0.2] m of the mesh: they would act twice on the liquid (remove the doubles in the "
            "program that made the mesh; a sheet is one layer of triangles, which hold the liquid on both "
            "sides)");
}

TEST(LiquidStart, RefusesASpeedOfSoundThatIsTooLow) {
  json scene = vat();
  scene["sph"]["liquids"][0]["sound_speed"] = 2;
  EXPECT_EQ(refusal(scene),
            "scene: sph.liquids[0].sound_speed: with a speed of sound of 2 m/s the liquid, 0.16 m deep, is "
            "compressed by 0.22 at its bottom by its own weight (limit 0.03) (leave it out and give "
            "expected_speed, or give 12.5 m/s or more)");
  scene["sph"]["liquids"][0]["sound_speed"] = 20;
  scene["sph"]["liquids"][0]["velocity"] = {3, 0, 0};
  EXPECT_EQ(
      refusal(scene),
      "scene: sph.liquids[0].sound_speed: the liquid starts with 3 m/s, 0.15 of the speed of sound of 20 "
      "m/s (limit 0.1) (leave it out and give expected_speed, or give 30 m/s or more)");
  scene["sph"]["liquids"][0].erase("sound_speed");
  const scene::Scene parsed = scene::parse(scene.dump(), "vat.json");
  expect_start("speed of sound by the velocity at the start [m/s]", 30,
               sph::prepare_start(parsed, {}).setup.liquid.sound_speed, 1e-9);
}

// A wall with an edge that the liquid is around, which is narrow.
TEST(LiquidStart, WarnsOfNarrowWallsWithEdgesInTheLiquid) {
  const auto warnings = [](const json& scene) {
    return sph::prepare_start(scene::parse(scene.dump(), "vat.json"), {}).warnings;
  };
  const auto with = [](Vec3d position, Vec3d size) {
    json scene = vat();
    scene["sph"]["walls"].push_back(box_wall("block", position, size));
    return scene;
  };
  const json block = with({0, 0, 0.06}, {0.08, 0.08, 0.04});
  const std::string sentence =
      "sph: wall 'block' of 'ground' has sharp edges in the liquid and is 0.04 m across, 2 spacings: the "
      "liquid there does not come to rest, and the mean of loads on it, such as its buoyancy, may be up to "
      "15 % too "
      "small. Give a spacing of 0.00332 m or less, for 12 spacings across";
  EXPECT_THAT(warnings(block), ElementsAre(sentence));
  json turned = block;
  turned["sph"]["walls"][1]["orientation"] = {{"euler_deg", {0, 0, 30}}, {"order", "zxz"}};
  EXPECT_THAT(warnings(turned), ElementsAre(sentence)) << "the extent is that along the axes of the wall";
  json boxes = block;
  fill_of(boxes) = {{{"type", "box"}, {"min", {0.04, -0.1, 0}}, {"max", {0.2, 0.1, 0.16}}},
                    {{"type", "box"}, {"min", {-0.2, 0.04, 0}}, {"max", {0.04, 0.1, 0.16}}},
                    {{"type", "box"}, {"min", {-0.2, -0.1, 0}}, {"max", {0.04, -0.04, 0.16}}}};
  EXPECT_THAT(warnings(boxes), ElementsAre(sentence)) << "in boxes of liquid";
  boxes["sph"]["walls"][1] = box_wall("block", {0, 0, 0.02}, {0.08, 0.08, 0.04});
  EXPECT_THAT(warnings(boxes), SizeIs(1)) << "on the floor";
  EXPECT_THAT(warnings(with({0, 0, 0.16}, {0.08, 0.08, 0.08})), SizeIs(1)) << "half of it in the liquid";
  json fine = block;
  fine["sph"]["spacing"] = 0.00332;
  EXPECT_THAT(warnings(fine), IsEmpty()) << "12 spacings across";
  EXPECT_THAT(warnings(with({0, 0, 0.24}, {0.08, 0.08, 0.08})), IsEmpty()) << "above the liquid";
  EXPECT_THAT(warnings(with({0, 0, -0.04}, {0.5, 0.3, 0.06})), IsEmpty()) << "below the floor";
  json ball = vat();
  ball["sph"]["walls"].push_back(
      {{"name", "ball"}, {"position", {0, 0, 0.08}}, {"shape", {{"type", "sphere"}, {"radius", 0.04}}}});
  EXPECT_THAT(warnings(ball), IsEmpty()) << "round";
  json lidded = vat();
  lidded["sph"]["walls"][0]["shape"].erase("open");
  lidded["sph"]["spacing"] = 0.04;
  EXPECT_THAT(warnings(lidded), IsEmpty()) << "a closed vessel of 5 spacings across";
}

TEST(LiquidStart, WarnsOfASpeedBeyondThatOfALiquid) {
  json scene = vat();
  const auto warnings = [&] {
    return sph::prepare_start(scene::parse(scene.dump(), "vat.json"), {}).warnings;
  };
  scene["sph"]["liquids"][0]["velocity"] = {100, 0, 0};
  EXPECT_TRUE(warnings().empty());
  scene["sph"]["liquids"][0]["velocity"] = {637, 0, 0};  // given in mm/s
  ASSERT_EQ(warnings().size(), 1u);
  EXPECT_NE(warnings()[0].find("reaches 637 m/s: are velocities in m/s"), std::string::npos) << warnings()[0];
  scene["sph"]["liquids"][0]["sound_speed"] = 6370;
  EXPECT_TRUE(warnings().empty()) << "the user has said so";
}

TEST(LiquidStart, FrictionIsThatOfThePair) {
  json scene = vat();
  const auto slip = [&] { return sph::prepare_start(scene::parse(scene.dump(), "vat.json"), {}).setup.slip; };
  EXPECT_EQ(slip(), std::vector<bool>{false});
  scene["sph"]["pairs"] = {{{"liquid", "water"}, {"body", "ground"}, {"wall_friction", "free_slip"}}};
  EXPECT_EQ(slip(), std::vector<bool>{true});
  scene["sph"]["wall_friction"] = "free_slip";
  scene["sph"]["pairs"][0]["wall_friction"] = "no_slip";
  EXPECT_EQ(slip(), std::vector<bool>{false});
}

TEST(LiquidStart, MemoryIsPredicted) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers allocate otherwise";
#else
  sph::LiquidStart start = sph::prepare_start(scene::parse(vat().dump(), "vat.json"), {});
  json scene = vat();
  scene["sph"]["spacing"] = 0.01;
  for (const bool copy : {false, true}) {
    const scene::Scene parsed = scene::parse(scene.dump(), "vat.json");
    start = sph::prepare_start(parsed, {});
    start.setup.threads = 1;
    const sph::LiquidState particles = sph::particles_of(start, parsed);
    const auto used = [] {
      const struct mallinfo2 now = mallinfo2();
      return static_cast<double>(now.uordblks + now.hblkhd);
    };
    const double before = used();
    const auto engine = sph::make_liquid_engine(start.setup, true);
    engine->set_state(particles, start.poses);
    engine->step(1e-6, start.poses);
    if (copy) engine->save();
    const double predicted =
        static_cast<double>(sph::predicted_bytes(particles.size(), start.setup, true, copy));
    // What is there for a while only, the list of a thread while it is built, is in the prediction.
    expect_start("memory in use / predicted", 0.7, (used() - before) / predicted, 0.3);
  }
#endif
}

// The vat as a body at rest, its floor a wall of its own.
json sensed_vat() {
  json scene = vat();
  scene["mbd"]["bodies"] = {
      {{"name", "vat"}, {"mass", 5}, {"inertia", {1, 1, 1}}, {"position", {0, 0, 0.1}}}};
  json sides = box_wall("sides", {0, 0, 0.05}, {0.4, 0.2, 0.3}),
       floor = box_wall("floor", {0, 0, 0.05}, {0.4, 0.2, 0.3});
  sides["shape"]["open"] = {"+z", "-z"};
  floor["shape"]["open"] = {"+x", "-x", "+y", "-y", "+z"};
  sides["body"] = floor["body"] = "vat";
  scene["sph"]["walls"] = {sides, floor};
  fill_of(scene)[0] = {{"type", "box"}, {"min", {-0.2, -0.1, 0}}, {"max", {0.2, 0.1, 0.16}}};
  const json in_vat = {{"body", "vat"}};
  const auto sensor = [&](json more) {
    more.update(in_vat);
    return more;
  };
  scene["sph"]["sensors"] = {
      {{"type", "load"},
       {"name", "floor_load"},
       {"wall", "floor"},
       {"position", {0.1, 0, -0.1}},
       {"axis", {0, 1, 0}}},
      sensor({{"type", "load"}, {"name", "all"}}),
      sensor({{"type", "level"}, {"name", "gauge"}, {"position", {0.05, 0.02, -0.1}}}),
      sensor({{"type", "pressure"}, {"name", "bottom"}, {"position", {0.03, 0.01, -0.1}}}),
      sensor({{"type", "pressure"}, {"name", "side"}, {"position", {0.2, 0.03, -0.05}}}),
      sensor({{"type", "pressure"},
              {"name", "floor_patch"},
              {"position", {0.03, 0.01, -0.1}},
              {"area", {0.06, 0.04}}}),
      sensor({{"type", "pressure"},
              {"name", "side_patch"},
              {"position", {0.2, 0.03, -0.05}},
              {"orientation", {std::sqrt(0.5), 0, -std::sqrt(0.5), 0}},
              {"area", {0.04, 0.06}}}),
      sensor({{"type", "pressure"},
              {"name", "dry_patch"},
              {"position", {0.2, 0, 0.15}},
              {"orientation", {std::sqrt(0.5), 0, -std::sqrt(0.5), 0}},
              {"area", {0.04, 0.04}}}),
      sensor({{"type", "region"},
              {"name", "right"},
              {"position", {0.1, 0, 0}},
              {"shape", {{"type", "box"}, {"size", {0.2, 1, 1}}}},
              {"flow", "x"}})};
  return scene;
}

class SensedRun {
 public:
  explicit SensedRun(const json& scene) {
    log::setup("test", "error");
    protocol::Configuration c;
    c.scene_text = scene.dump();
    c.origin = "vat.json";
    c.backend = "cpu";
    c.threads = 1;
    const scene::Scene parsed = scene::parse(c.scene_text, c.origin);
    scene::validate(parsed, c.origin);
    columns = scene::sensor_columns(parsed);
    at_start = solver->configure(c).sensors;
  }
  const protocol::LoadSet& advance() {
    protocol::MotionSet motion;
    motion.window = {index, now, now + to_nanoseconds(0.002)};
    protocol::BodyMotion& body = motion.bodies.emplace_back();
    body.body = 0;
    body.begin_pose = body.end_pose = Pose{{0, 0, 0.1}, {}};
    ++index;
    now = motion.window.end;
    return solver->advance(motion);
  }
  std::unique_ptr<protocol::LoadSolver> solver = sph::make_solver();
  std::vector<std::string> columns;
  std::vector<double> at_start;
  std::uint64_t index = 0;
  Nanoseconds now;
};

TEST(LiquidSensors, MeasureAStillVat) {
  SensedRun run(sensed_vat());
  ASSERT_EQ(run.columns.size(), run.at_start.size());
  const int settle = 100, windows = 50;
  for (int i = 0; i < settle; ++i) run.advance();
  std::map<std::string, double> mean;
  Vec3d force, torque;
  for (int i = 0; i < windows; ++i) {
    const protocol::LoadSet& load = run.advance();
    ASSERT_EQ(load.bodies.size(), 1u) << "one body, though its walls are apart";
    ASSERT_EQ(load.sensors.size(), run.columns.size());
    for (std::size_t k = 0; k < run.columns.size(); ++k) mean[run.columns[k]] += load.sensors[k] / windows;
    force += (1.0 / windows) * load.bodies[0].mean.force;
    torque += (1.0 / windows) * load.bodies[0].mean.torque;
  }
  const double weight = 1000 * 0.4 * 0.2 * 0.16 * 9.81;
  expect_start("load on the floor [N]", -weight, mean["floor_load.force.z"], 0.03 * weight);
  expect_start("load on the body", force.z, mean["all.force.z"], 1e-9 * weight);
  expect_start("its torque about y", torque.y, mean["all.torque.y"], 1e-9 * weight);
  // About a point at x = 0.1 the weight at x = 0 has the arm 0.1 m.
  expect_start("torque of the floor about y [N m]", -0.1 * weight, mean["floor_load.torque.y"],
               0.003 * weight);
  expect_start("the same about the axis", mean["floor_load.torque.y"], mean["floor_load.axis_torque"],
               1e-9 * weight);
  expect_start("level above the floor [m]", 0.16, mean["gauge.level"], 0.15 * 0.02);
  expect_start("pressure at the bottom [Pa]", 9810 * 0.16, mean["bottom.pressure"], 0.03 * 9810 * 0.16);
  expect_start("pressure at a side", 9810 * 0.11, mean["side.pressure"], 0.03 * 9810 * 0.16);
  expect_start("load per area of a patch of the floor", 9810 * 0.16, mean["floor_patch.pressure"],
               0.03 * 9810 * 0.16);
  expect_start("of a patch of a side", 9810 * 0.11, mean["side_patch.pressure"], 0.03 * 9810 * 0.16);
  expect_start("of a patch above the liquid", 0, mean["dry_patch.pressure"], 0);
  expect_start("mass in the right half [kg]", 6.4, mean["right.mass"], 1e-9);
  expect_start("volume there [m3]", 6.4e-3, mean["right.volume"], 0.01 * 6.4e-3);
  expect_start("mass that passed [kg]", 0, mean["right.passed"], 0.01);
}

// As of a vessel that is empty.
TEST(LiquidSensors, HaveLevelZeroWithoutLiquid) {
  json scene = vat();
  const auto gauge = [&](double x, double z) {
    scene["sph"]["sensors"] = {{{"type", "level"}, {"name", "gauge"}, {"position", {x, 0, z}}}};
    return SensedRun(scene).at_start.at(0);
  };
  EXPECT_EQ(gauge(0.3, 0), 0) << "outside of the vat";
  EXPECT_NEAR(gauge(0.01, 0), 0.16, 0.003);
  EXPECT_NEAR(gauge(0.01, 0.2), -0.04, 0.003) << "from above the surface";
  scene["sph"]["liquids"][0]["fill"] = json::array();
  scene["sph"]["inlets"] = {{{"name", "pipe"},
                             {"position", {0, 0, 0}},
                             {"shape", {{"type", "rectangle"}, {"size", {0.04, 0.04}}}},
                             {"velocity", 0.5}}};
  EXPECT_EQ(gauge(0.01, 0), 0) << "before the liquid comes in";
}

TEST(LiquidSensors, HaveTheSameBitsAfterARollback) {
  SensedRun run(sensed_vat());
  for (int i = 0; i < 5; ++i) run.advance();
  run.solver->save();
  const auto [index, now] = std::pair(run.index, run.now);
  std::vector<std::vector<double>> first;
  for (int i = 0; i < 5; ++i) first.push_back(run.advance().sensors);
  run.solver->restore();
  run.index = index, run.now = now;
  for (const std::vector<double>& values : first) EXPECT_TRUE(run.advance().sensors == values);
}

TEST(LiquidSensors, RefuseAnAreaWithoutAWall) {
  json scene = sensed_vat();
  scene["sph"]["sensors"][5]["position"] = {0, 0, 0};
  const std::string sentence = test::error_of([&] { SensedRun run(scene); });
  EXPECT_NE(sentence.find("area of sensor 'floor_patch'"), std::string::npos) << sentence;
}

// Sensors do not change the liquid, up to the rounding of single precision: areas cut triangles into several,
// and what walls do is summed up body by body, of which a wall with a sensor is one.
TEST(LiquidSensors, LeaveTheLiquidAsItIs) {
  json without = sensed_vat(), no_areas = sensed_vat();
  without["sph"].erase("sensors");
  json& sensors = no_areas["sph"]["sensors"];
  std::erase_if(sensors.get_ref<json::array_t&>(),
                [](const json& sensor) { return sensor.contains("area"); });
  ASSERT_EQ(sensors.size(), 6u);
  SensedRun a(sensed_vat()), b(no_areas), c(without);
  for (int i = 0; i < 20; ++i) {
    const Vec3d with_areas = a.advance().bodies[0].mean.force, with = b.advance().bodies[0].mean.force,
                plain = c.advance().bodies[0].mean.force;
    EXPECT_LT(norm(with - plain), 2e-8 * norm(plain));
    EXPECT_LT(norm(with_areas - plain), 2e-8 * norm(plain));
  }
}

}  // namespace
}  // namespace tandem::test
