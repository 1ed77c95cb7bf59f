// Walls of different bodies that pass through each other are detected; walls that are in contact, connected,
// or overlap from the start cause no objection.
#include "coordinator/verdict/wall_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

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

// Bodies with the names `bodies`, 1 m apart along x, 1 m above the ground.
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

// A wheel of radius 0.3 that moves down onto `floor`; the height of its centre is 1 at the start.
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
  for (const double height : {0.9, 0.5, 0.31, 0.3, 0.2995})
    watch.observe(1 - height, poses(scene, {0, 0, height}));
  EXPECT_THAT(watch.crossings(), IsEmpty());
  for (const double height : {0.28, 0.25, 0.2, 0.1, -1.0})
    watch.observe(1 - height, poses(scene, {0, 0, height}), true);
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
  // Also at the corner of the slab, rotated, and overlapping by less than 1 % of its thickness.
  for (const double x : {0.5, 0.05, -0.05})
    for (const double y : {0.0, 1.0})
      for (const double turn : {0.0, 0.3, 0.785398})
        watch.observe(x, poses(scene, {x, y, 0.0999}, exp({0, 0, turn})), true);
  EXPECT_THAT(watch.crossings(), IsEmpty());
  watch.observe(1, poses(scene, {0.5, 0, 0.095}, exp({0, 0, 0.3})), true);
  ASSERT_THAT(watch.crossings(), SizeIs(1));
  EXPECT_NEAR(watch.crossings()[0].depth, 0.005, 1e-7);
}

TEST(WallWatch, MeshesAreSurfaces) {
  scene::Scene scene = scene_of({"ball"});
  scene.dem->walls = {wall("ball", first, scene::SphereShape{0.1}),
                      wall("sheet", ground, scene::MeshShape{"sheet.stl"})};
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
    scene.dem->walls = {wall("of_a", first, scene::SphereShape{0.3}),
                        wall("of_b", second, scene::SphereShape{0.3})};
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

using WallShape = decltype(scene::Wall::shape);

// Walls with faces in one plane, or with coincident edges: in exact arithmetic neither crosses the other.
struct Aligned {
  const char* name;
  WallShape one, other;  // of two bodies; `other` at the origin
  // Positions of `one` without an objection, and positions that each cause one.
  std::vector<Vec3d> may, may_not;
  double turn = 0;  // of `one` about z [rad]
};

// A closed box as a mesh whose triangles are divided into four, without common vertices.
WallShape cut(const WallShape& shape, NamedMesh& mesh) {
  const auto* box = std::get_if<scene::BoxShape>(&shape);
  if (!box) return shape;
  const TriangleMesh whole = box_mesh(box->size, box->open);
  for (const auto& [i, j, k] : whole.triangles) {
    const Vec3d a = whole.vertices[i], b = whole.vertices[j], c = whole.vertices[k], ab = 0.5 * (a + b),
                bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    for (const auto& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
      const auto corner = static_cast<std::uint32_t>(mesh.mesh.vertices.size());
      mesh.mesh.vertices.insert(mesh.mesh.vertices.end(), t.begin(), t.end());
      mesh.mesh.triangles.push_back({corner, corner + 1, corner + 2});
    }
  }
  return scene::MeshShape{"box.stl"};
}

const std::vector<Aligned>& aligned_walls() {
  const scene::BoxShape cube{{1, 1, 1}, {}}, plate{{1, 1, 0.5}, {}}, half{{0.5, 1, 1}, {}},
      bin{{1, 1, 1}, {"+z"}}, lid{{1, 1, 1}, {"-z"}}, plank_x{{2, 0.4, 0.2}, {}}, plank_y{{0.4, 2, 0.2}, {}},
      sheet{{0.001, 1, 1}, {}};
  const scene::CylinderShape round{0.5, 1, {}, {}};
  static const std::vector<Aligned> all = {
      {"SameSection",
       cube,
       plate,
       {{0, 0, 2}, {0, 0, 0.75}, {0, 0, 0.746}},
       {{0, 0, 0.74}, {0, 0, 0.5}, {0, 0, 0.25}, {0, 0, 0.1}, {0, 0, 0}, {0, 0, -0.74}}},
      {"Turned",
       cube,
       plate,
       {{0, 0, 0.75}, {0, 0, 0.746}},
       {{0, 0, 0.74}, {0, 0, 0.3}},
       std::numbers::pi / 2},
      {"OnePlane",
       half,
       plate,
       {{0.25, 0, 0.75}, {0.25, 0, 0.746}},
       {{0.25, 0, 0.74}, {0.25, 0, 0.1}, {0.25, 0, -0.5}}},
      {"TwoPlanes", half, plate, {{0, 0, 0.75}}, {{0, 0, 0.74}, {0, 0, 0.2}, {0.1, 0, 0}}},
      {"Coincident", cube, cube, {{2, 0, 0}}, {{0, 0, 0}, {1e-9, 0, 0}}},
      {"Planks",
       plank_x,
       plank_y,
       {{1.5, 0, 0}, {1.2, 0, 0}, {1.1985, 0, 0}, {0, 0, 0.2}},
       {{1.197, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0.1}}},
      {"SideBySide",
       cube,
       cube,
       {{1, 0, 2},
        {1, 0, 0.5},
        {1, 0, 0},
        {0.991, 0, 0.5},
        {0.991, 0, 0},
        {1, 1, 0},
        {1, 1, 1},
        {0.991, 0.991, 0.3}},
       {{0.98, 0, 0.5}, {0.98, 0, 0}, {0.98, 0.98, 0.3}}},
      {"RoundOnRound", round, round, {{0, 0, 1}, {0, 0, 0.992}}, {{0, 0, 0.98}, {0, 0, 0.5}, {0, 0, 0}}},
      {"RoundInBox", round, plate, {{0, 0, 0.75}}, {{0, 0, 0.74}, {0, 0, 0.25}, {0, 0, 0}}},
      {"IntoABin",
       cube,
       bin,
       {{0, 0, 2}, {0, 0, 1}, {0, 0, 0.3}, {0, 0, 0}, {0, 0, -0.004}},
       {{0, 0, -0.02}, {0, 0, -0.5}}},
      {"LidOnABox", lid, cube, {{0, 0, 2}, {0, 0, 1}, {0, 0, 0.3}, {0, 0, 0}}, {{0, 0, -0.02}, {0, 0, -0.5}}},
      {"ThinPlate",
       sheet,
       cube,
       {{0.5, 0, 1}, {0.5005, 0, 0.3}},
       {{0.4995, 0, 0.5}, {0.4995, 0, 0}, {0, 0, 0.9}}},
      {"OnAPlane",
       cube,
       scene::PlaneShape{{0, 0, 0}, {0, 0, 1}},
       {{0, 0, 0.5}, {0, 0, 0.491}},
       {{0, 0, 0.489}, {0, 0, 0}}},
  };
  return all;
}

class AlignedWalls : public ::testing::TestWithParam<Aligned> {};

TEST_P(AlignedWalls, PassThroughEachOtherOrNotWhereverTheyStand) {
  const Aligned& c = GetParam();
  std::mt19937 random(31);
  std::normal_distribution<double> normal;
  for (const bool meshes : {false, true})
    for (int i = 0; i < 40; ++i) {
      // The first as given; then some about the origin, and others far from it.
      const double away = i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : 100;
      const Pose at =
          i == 0 ? Pose{}
                 : Pose{away * Vec3d{normal(random), normal(random), normal(random)},
                        Quat{normal(random), normal(random), normal(random), normal(random)}.normalized()};
      const auto moved = [&](Vec3d p) { return at.p_WB + at.q_WB.rotate(p); };
      const Quat turn = at.q_WB * exp({0, 0, c.turn});
      scene::Scene scene = scene_of({"one", "other"});
      std::vector<NamedMesh> named = {{"one", {}}, {"other", {}}};
      std::visit([&](const auto& shape) { scene.dem->walls.push_back(wall("one", first, shape)); },
                 meshes ? cut(c.one, named[0]) : c.one);
      std::visit([&](const auto& shape) { scene.dem->walls.push_back(wall("other", second, shape)); },
                 meshes ? cut(c.other, named[1]) : c.other);
      scene.mbd->bodies[0].pose = {moved({0, 0, 10}), turn};
      scene.mbd->bodies[1].pose = at;
      WallWatch all(scene, named);
      ASSERT_TRUE(all.judges());
      for (const Vec3d& p : c.may) {
        all.observe(0, poses(scene, moved(p), turn), true);
        ASSERT_THAT(all.crossings(), IsEmpty())
            << "at " << p.x << ' ' << p.y << ' ' << p.z << ", motion " << i
            << (meshes ? " as mesh, depth " : ", depth ") << all.crossings()[0].depth;
      }
      for (const Vec3d& p : c.may_not) {
        WallWatch watch(scene, named);
        watch.observe(0, poses(scene, moved(p), turn), true);
        ASSERT_THAT(watch.crossings(), SizeIs(1))
            << "at " << p.x << ' ' << p.y << ' ' << p.z << ", motion " << i << (meshes ? " as mesh" : "");
      }
    }
}

INSTANTIATE_TEST_SUITE_P(WallWatch, AlignedWalls, ::testing::ValuesIn(aligned_walls()),
                         [](const auto& of) { return std::string(of.param.name); });

// Depths of aligned walls are those of the original walls, not of the shrunk ones.
TEST(WallWatch, DepthOfABoxThatFallsThroughOneOfItsSection) {
  scene::Scene scene = scene_of({"one", "other"});
  scene.dem->walls = {wall("one", first, scene::BoxShape{{1, 1, 1}, {}}),
                      wall("other", second, scene::BoxShape{{1, 1, 0.5}, {}})};
  scene.mbd->bodies[0].pose.p_WB = {0, 0, 10};
  scene.mbd->bodies[1].pose.p_WB = {};
  WallWatch watch(scene, {});
  watch.observe(1, poses(scene, {0, 0, 0.65}), true);
  ASSERT_THAT(watch.crossings(), SizeIs(1));
  EXPECT_NEAR(watch.crossings()[0].depth, 0.1, 1e-6);
  EXPECT_NEAR(watch.crossings()[0].share, 0.2, 1e-6);
}

// The triangles of a fine mesh are smaller than the detection depth.
TEST(WallWatch, AFineBallFallsThroughASlab) {
  scene::Scene scene = scene_of({"ball"});
  scene.dem->walls = {wall("ball", first, scene::MeshShape{"ball.stl"}),
                      wall("slab", ground, slab, {0, 0, -0.05})};
  WallWatch watch(scene, {{"ball", sphere_mesh(0.1, 300)}});
  for (const double height : {0.15, 0.1, 0.0995}) watch.observe(0, poses(scene, {0, 0, height}), true);
  EXPECT_THAT(watch.crossings(), IsEmpty());
  watch.observe(1, poses(scene, {0, 0, 0.098}), true);
  ASSERT_THAT(watch.crossings(), SizeIs(1));
  watch.observe(2, poses(scene, {0, 0, 0.05}), true);
  EXPECT_NEAR(watch.crossings()[0].depth, 0.05, 0.002);
}

// A vessel of sheet metal is a closed mesh that encloses the sheet: objects on the sheet, on either side, are
// allowed.
TEST(WallWatch, WallsOfSheetMetalAreNotTakenForThickOnes) {
  scene::Scene scene = scene_of({"bucket"});
  scene.dem->walls = {wall("bucket", first, scene::MeshShape{"bucket.stl"}),
                      wall("slab", ground, slab, {0, 0, -0.05}),
                      wall("load", ground, scene::BoxShape{{0.2, 0.2, 0.2}, {}}, {0, 0, 0.102})};
  // Two open boxes, the inner one with inverted winding, and the rim between them.
  TriangleMesh bucket = box_mesh({1, 1, 1}, {"+z"}), inner = box_mesh({0.996, 0.996, 0.998}, {"+z"});
  for (Vec3d& v : inner.vertices) v.z += 0.001;
  for (const Vec3d& v : inner.vertices) bucket.vertices.push_back(v);
  for (const auto& [i, j, k] : inner.triangles) bucket.triangles.push_back({i + 8, k + 8, j + 8});
  for (const auto& [i, j] : {std::array{4u, 5u}, {5u, 7u}, {7u, 6u}, {6u, 4u}}) {
    bucket.triangles.push_back({i, j, j + 8});
    bucket.triangles.push_back({i, j + 8, i + 8});
  }
  scene.mbd->bodies[0].pose.p_WB = {0, 0, 2};
  WallWatch watch(scene, {{"bucket", bucket}});
  for (const double height : {0.501, 0.5, 0.4998}) watch.observe(0, poses(scene, {0, 0, height}), true);
  EXPECT_THAT(watch.crossings(), IsEmpty());
  watch.observe(1, poses(scene, {0, 0, 0.45}), true);
  EXPECT_THAT(watch.crossings(), SizeIs(1));
  watch.observe(2, poses(scene, {0, 0, 0.55}), true);
  EXPECT_THAT(watch.crossings(), SizeIs(2));
}

// For an object that is inside a closed vessel from the start, the vessel's wall is a shell: the object may
// be in a corner, and passes through the wall when it leaves.
TEST(WallWatch, AClosedVesselIsHollowForWhatIsInIt) {
  scene::Scene scene = scene_of({"load", "vessel"});
  scene.dem->walls = {wall("load", first, scene::BoxShape{{0.2, 0.2, 0.2}, {}}),
                      wall("vessel", second, scene::BoxShape{{1, 1, 1}, {}})};
  scene.mbd->bodies[0].pose.p_WB = scene.mbd->bodies[1].pose.p_WB = {};
  WallWatch watch(scene, {});
  EXPECT_TRUE(watch.judges());
  for (const Vec3d& p : {Vec3d{0.4, 0, 0}, Vec3d{0.4, 0.4, 0}, Vec3d{0.4, 0.4, -0.4}, Vec3d{0, 0, -0.4015}})
    watch.observe(0, poses(scene, p), true);
  EXPECT_THAT(watch.crossings(), IsEmpty());
  watch.observe(1, poses(scene, {0, 0, -0.45}), true);
  EXPECT_THAT(watch.crossings(), SizeIs(1));
}

// A slider on the ground can still fall through the floor; the post with its joint counts as connected.
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
  scene.dem->walls = {wall("ball", first, scene::SphereShape{0.1}),
                      wall("scan", ground, scene::MeshShape{"scan.stl"})};
  const WallWatch fine(scene, {{"scan", sphere_mesh(1, 400)}});
  EXPECT_THAT(fine.not_judged(), ElementsAre(HasSubstr("more than 100000 triangles: 'scan'")));
  EXPECT_FALSE(fine.judges());
  scene.dem->walls.resize(1);
  for (int i = 0; i < 5001; ++i) scene.dem->walls.push_back(wall("grain", ground, scene::SphereShape{0.1}));
  EXPECT_THAT(WallWatch(scene, {}).not_judged(), ElementsAre(HasSubstr("more than 5000 pairs of walls")));
}

// Fine meshes that remain entangled cost a limited amount of work per window.
TEST(WallWatch, WorkIsBounded) {
  scene::Scene scene = scene_of({"ball"});
  scene.dem->walls = {wall("ball", first, scene::MeshShape{"a"}),
                      wall("bowl", ground, scene::MeshShape{"b"}, {0, 0, -1})};
  WallWatch watch(scene, {{"ball", sphere_mesh(0.5, 40)}, {"bowl", sphere_mesh(0.5, 40)}});
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 2000; ++i)
    watch.observe(i, poses(scene, {0, 0, -0.8 + 0.1 * (i % 2)}, exp({0, 0, 0.3 * i})));
  EXPECT_THAT(watch.crossings(), SizeIs(1));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("  two balls of %zu triangles that stay entangled: %.1f us per window\n",
              sphere_mesh(0.5, 40).triangles.size(), 1e6 * seconds / 2000);
  EXPECT_LT(seconds, 5);
}

}  // namespace
}  // namespace tandem::launch
