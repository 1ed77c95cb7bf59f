// Walls of different bodies that pass through each other are seen; those that touch, hang together or overlap
// from the start are not objected to.
#include "launch/verdict/wall_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>

namespace tandem::launch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

scene::Body body(const char* name, Vec3d position) {
  scene::Body body;
  body.name = name;
  body.mass = 1;
  body.inertia = {1, 1, 1, 0, 0, 0};
  body.pose.p_WB = position;
  return body;
}

template <class Shape>
scene::Wall wall(const char* name, BodyId of, Shape shape, Vec3d position = {}) {
  scene::Wall wall;
  wall.name = name;
  wall.body = of;
  wall.shape = shape;
  wall.pose.p_WB = position;
  return wall;
}

scene::Joint joint(scene::JointType type, BodyId parent, BodyId child, Vec3d position) {
  scene::Joint joint;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.position = position;
  return joint;
}

// Bodies of the names of `bodies`, 1 m apart along x, 1 m above the ground.
scene::Scene scene_of(std::vector<const char*> bodies) {
  scene::Scene scene;
  scene.mbd.emplace();
  for (std::size_t i = 0; i < bodies.size(); ++i)
    scene.mbd->bodies.push_back(body(bodies[i], {static_cast<double>(i), 0, 1}));
  scene.dem.emplace();
  scene.dem->domain = {{-5, -5, -5}, {5, 5, 5}};
  return scene;
}

constexpr BodyId first{0}, second{1};

std::vector<protocol::BodyState> poses(const scene::Scene& scene, Vec3d of_first, Quat q = {}) {
  std::vector<protocol::BodyState> all(scene.mbd->bodies.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i].pose = scene.mbd->bodies[i].pose;
  all[0].pose = {of_first, q};
  return all;
}

// A wheel of radius 0.3 that comes down on `floor`; its centre's height is 1 at the start.
scene::Scene wheel_above(scene::Wall floor) {
  scene::Scene scene = scene_of({"wheel"});
  scene.dem->walls = {wall("tyre", first, scene::CylinderShape{0.3, 0.2, {}, {}}), std::move(floor)};
  scene.dem->walls[0].pose.q_WB = exp({std::numbers::pi / 2, 0, 0});
  return scene;
}

const scene::PlaneShape ground_plane{{0, 0, 0}, {0, 0, 1}};
const scene::BoxShape slab{{2, 2, 0.1}, {}};

class Floors : public ::testing::TestWithParam<scene::Wall> {};

TEST_P(Floors, AWheelMayStandOnThemButNotFallThrough) {
  const scene::Scene scene = wheel_above(GetParam());
  WallWatch watch(scene, {});
  ASSERT_TRUE(watch.judges());
  EXPECT_THAT(watch.not_judged(), IsEmpty());
  for (const double height : {0.9, 0.5, 0.31, 0.3, 0.2995}) watch.observe(1 - height, poses(scene, {0, 0, height}));
  EXPECT_THAT(watch.crossings(), IsEmpty());
  for (const double height : {0.28, 0.25, 0.2, 0.1, -1.0}) watch.observe(1 - height, poses(scene, {0, 0, height}), true);
  ASSERT_THAT(watch.crossings(), SizeIs(1));
  const WallCrossing& c = watch.crossings()[0];
  EXPECT_EQ(c.wall_a + c.body_a + c.wall_b + c.body_b, "tyrewheelfloorground");
  EXPECT_DOUBLE_EQ(c.time, 0.72);
  EXPECT_GT(c.depth, 0.01);
}

INSTANTIATE_TEST_SUITE_P(WallWatch, Floors,
                         ::testing::Values(wall("floor", ground, ground_plane),
                                           wall("floor", ground, slab, {0, 0, -0.05})),
                         [](const auto& of) { return of.index == 0 ? "Plane" : "Box"; });

TEST(WallWatch, DepthBehindAPlaneIsExact) {
  const scene::Scene scene = wheel_above(wall("floor", ground, ground_plane));
  WallWatch watch(scene, {});
  watch.observe(0.1, poses(scene, {0, 0, 0.2}));
  ASSERT_THAT(watch.crossings(), SizeIs(1));
  EXPECT_NEAR(watch.crossings()[0].depth, 0.1, 0.003);  // a prism of 24 sides
  EXPECT_NEAR(watch.crossings()[0].share, 0.5, 0.02);
}

TEST(WallWatch, ABodyLeavesAHollowOneThroughItsWallButNotThroughItsOpening) {
  scene::Scene scene = scene_of({"pallet"});
  scene.dem->walls = {wall("load", first, scene::BoxShape{{0.2, 0.2, 0.2}, {}}),
                      wall("bin", ground, scene::BoxShape{{1, 1, 1}, {"+z"}}, {0, 0, 1})};
  WallWatch up(scene, {}), sideways(scene, {});
  EXPECT_THAT(up.not_judged(), IsEmpty());
  for (double way = 0; way < 2; way += 0.05) {
    up.observe(way, poses(scene, {0, 0, 1 + way}), true);
    sideways.observe(way, poses(scene, {way, 0, 1}), true);
  }
  EXPECT_THAT(up.crossings(), IsEmpty());
  ASSERT_THAT(sideways.crossings(), SizeIs(1));
  EXPECT_GT(sideways.crossings()[0].depth, 0.05);
}

TEST(WallWatch, FacesMayLieOnEachOther) {
  scene::Scene scene = scene_of({"brick"});
  scene.dem->walls = {wall("brick", first, scene::BoxShape{{0.2, 0.2, 0.2}, {}}),
                      wall("slab", ground, slab, {0.95, 0, -0.05})};
  WallWatch watch(scene, {});
  // Also at the corner of the slab, turned, and pressed in by less than 1 % of its thickness.
  for (const double x : {0.5, 0.05, -0.05})
    for (const double y : {0.0, 1.0})
      for (const double turn : {0.0, 0.3, 0.785398})
        watch.observe(x, poses(scene, {x, y, 0.0999}, exp({0, 0, turn})), true);
  EXPECT_THAT(watch.crossings(), IsEmpty());
  watch.observe(1, poses(scene, {0.5, 0, 0.095}, exp({0, 0, 0.3})), true);
  ASSERT_THAT(watch.crossings(), SizeIs(1));
  EXPECT_NEAR(watch.crossings()[0].depth, 0.005, 1e-9);
}

TEST(WallWatch, MeshesAreSurfaces) {
  scene::Scene scene = scene_of({"ball"});
  scene.dem->walls = {wall("ball", first, scene::SphereShape{0.1}), wall("sheet", ground, scene::MeshShape{"sheet.stl"})};
  const NamedMesh sheet{"sheet", {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}}};
  WallWatch watch(scene, {sheet});
  watch.observe(0, poses(scene, {0, 0, 0.1}));
  EXPECT_THAT(watch.crossings(), IsEmpty());
  watch.observe(1, poses(scene, {0, 0, 0.05}));
  EXPECT_THAT(watch.crossings(), SizeIs(1));
  WallWatch beside(scene, {sheet});
  beside.observe(1, poses(scene, {1.2, 0, 0.05}), true);
  EXPECT_THAT(beside.crossings(), IsEmpty());
}

TEST(WallWatch, BodiesThatHangTogetherAreNotJudged) {
  const auto crossings = [](scene::JointType type) {
    scene::Scene scene = scene_of({"a", "b"});
    scene.dem->walls = {wall("of_a", first, scene::SphereShape{0.3}), wall("of_b", second, scene::SphereShape{0.3})};
    scene.mbd->joints = {joint(type, first, second, {0.5, 0, 1})};
    WallWatch watch(scene, {});
    watch.observe(1, poses(scene, {0.6, 0, 1}), true);
    return watch.crossings().size();
  };
  EXPECT_EQ(crossings(scene::JointType::revolute), 0u);
  EXPECT_EQ(crossings(scene::JointType::fixed), 0u);
  EXPECT_EQ(crossings(scene::JointType::free), 1u);
  EXPECT_EQ(crossings(scene::JointType::distance), 1u);
}

// A slider on the ground falls through the floor all the same; the post that bears its joint belongs to it.
TEST(WallWatch, OfTheGroundOnlyTheWallThatBearsAJointBelongsToIt) {
  scene::Scene scene = scene_of({"gate"});
  scene.dem->walls = {wall("leaf", first, scene::BoxShape{{1, 0.1, 1}, {}}),
                      wall("post", ground, scene::BoxShape{{0.2, 0.2, 2}, {}}, {-0.61, 0, 1}),
                      wall("floor", ground, ground_plane)};
  scene.mbd->joints = {joint(scene::JointType::revolute, ground, first, {-0.5, 0, 1})};
  WallWatch watch(scene, {});
  watch.observe(1, poses(scene, {-0.3, 0, 0.2}), true);
  ASSERT_THAT(watch.crossings(), SizeIs(1));
  EXPECT_EQ(watch.crossings()[0].wall_b, "floor");
}

TEST(WallWatch, WallsThatOverlapInTheSceneAreSaidAndLeftAlone) {
  const scene::Scene scene = wheel_above(wall("floor", ground, ground_plane, {0, 0, 0.8}));
  WallWatch watch(scene, {});
  EXPECT_FALSE(watch.judges());
  EXPECT_THAT(watch.not_judged(), ElementsAre(HasSubstr("'tyre' and 'floor'")));
}

TEST(WallWatch, BodiesWithoutWallsAreNamedOnce) {
  scene::Scene scene = scene_of({"a", "b"});
  scene.dem->walls = {wall("of_a", first, scene::SphereShape{0.3})};
  WallWatch watch(scene, {});
  EXPECT_THAT(watch.not_judged(), ElementsAre(HasSubstr("1 body without walls ('b')")));
  scene.dem.reset();
  EXPECT_THAT(WallWatch(scene, {}).not_judged(), ElementsAre(HasSubstr("2 bodies without walls ('a', 'b')")));
}

TEST(WallWatch, WhatWouldTakeTooLongIsSaid) {
  scene::Scene scene = scene_of({"ball"});
  scene.dem->walls = {wall("ball", first, scene::SphereShape{0.1}), wall("scan", ground, scene::MeshShape{"scan.stl"})};
  const WallWatch fine(scene, {{"scan", sphere_mesh(1, 400)}});
  EXPECT_THAT(fine.not_judged(), ElementsAre(HasSubstr("more than 100000 triangles: 'scan'")));
  EXPECT_FALSE(fine.judges());
  scene.dem->walls.resize(1);
  for (int i = 0; i < 5001; ++i) scene.dem->walls.push_back(wall("grain", ground, scene::SphereShape{0.1}));
  EXPECT_THAT(WallWatch(scene, {}).not_judged(), ElementsAre(HasSubstr("more than 5000 pairs of walls")));
}

// Fine meshes that stay entangled cost a bounded amount of work per window.
TEST(WallWatch, WorkIsBounded) {
  scene::Scene scene = scene_of({"ball"});
  scene.dem->walls = {wall("ball", first, scene::MeshShape{"a"}), wall("bowl", ground, scene::MeshShape{"b"}, {0, 0, -1})};
  WallWatch watch(scene, {{"ball", sphere_mesh(0.5, 40)}, {"bowl", sphere_mesh(0.5, 40)}});
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 2000; ++i)
    watch.observe(i, poses(scene, {0, 0, -0.8 + 0.1 * (i % 2)}, exp({0, 0, 0.3 * i})));
  EXPECT_THAT(watch.crossings(), SizeIs(1));
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 5);
}

}  // namespace
}  // namespace tandem::launch
