// Packings: independent checks of overlaps, of the inside of containers and of mass.
#include "particles/io/place.hpp"
#include "tests/support/torus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/mass_properties.hpp"
#include "common/geometry/solid_mesh.hpp"
#include "common/scene/sizes.hpp"
#include "tests/unit/dem_geometry/walls.hpp"

namespace tandem::particles::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

scene::Scene scene_with(const scene::PackingFill& fill, double radius,
                        const std::vector<scene::Wall>& walls) {
  scene::Scene scene = empty_scene();
  scene.dem->walls = walls;
  scene::ParticleGroup group;
  group.name = "grains";
  group.radius_min = group.radius_max = radius;
  group.fill = fill;
  scene.dem->particles.push_back(group);
  return scene;
}

// The largest overlap of two spheres, relative to the smaller one; every pair is computed.
double worst_pair(const Placement& p) {
  double worst = 0;
  for (std::size_t i = 0; i < p.radius.size(); ++i)
    for (std::size_t j = i + 1; j < p.radius.size(); ++j)
      worst = std::max(worst, (p.radius[i] + p.radius[j] - norm(p.position[i] - p.position[j])) /
                                  std::min(p.radius[i], p.radius[j]));
  return worst;
}

double distance_to_segment(Vec3d p, Vec3d a, Vec3d b) {
  const double t = std::clamp(dot(p - a, b - a) / norm2(b - a), 0.0, 1.0);
  return norm(p - a - t * (b - a));
}
double distance_to_triangle(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d n = normalized(cross(b - a, c - a)), q = p - dot(n, p - a) * n;
  const bool inside = dot(cross(b - a, q - a), n) >= 0 && dot(cross(c - b, q - b), n) >= 0 &&
                      dot(cross(a - c, q - c), n) >= 0;
  if (inside) return norm(p - q);
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

// The smallest gap between a sphere and the mesh, relative to its radius; negative for an overlap.
double least_gap(const Placement& p, const TriangleMesh& mesh) {
  double least = 1e300;
  for (std::size_t i = 0; i < p.radius.size(); ++i)
    for (const auto& t : mesh.triangles)
      least = std::min(least, distance_to_triangle(p.position[i], mesh.vertices[t[0]], mesh.vertices[t[1]],
                                                   mesh.vertices[t[2]]) /
                                      p.radius[i] -
                                  1);
  return least;
}

scene::PackingFill inside(const std::string& wall_name) {
  scene::PackingFill fill;
  fill.region = scene::InsideWall{wall_name};
  return fill;
}

std::string refusal(const scene::Scene& scene, const std::vector<NamedMesh>& meshes = {}) {
  try {
    place(scene, 0, meshes, {}, {}, 1);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::scene);
    return error.what();
  }
  return "no error";
}

TEST(Place, RingIsFilledWithoutOverlapsAndNotItsHole) {
  const TriangleMesh ring = tandem::test::torus(0.2, 0.08, 40, 20);
  scene::PackingFill fill = inside("mesh");
  fill.void_fraction = 0.5;
  const scene::Scene scene = scene_with(fill, 0.01, {wall("mesh", scene::MeshShape{"ring.stl"})});
  const Placement p = place(scene, 0, {{"mesh", ring}}, {}, {}, 2);
  EXPECT_LE(worst_pair(p), 1e-9);
  EXPECT_GE(least_gap(p, ring), -1e-6);
  for (const Vec3d& x : p.position) EXPECT_NEAR(std::abs(winding_number(ring, x)), 1, 1e-6);
  const double volume = mass_of_mesh(ring, 1).mass;
  EXPECT_NEAR(p.volume, volume, 1e-3 * volume);
  EXPECT_NEAR(1 - scene::volume_of(p.radius) / volume, 0.5, 0.005);
  std::printf("%zu spheres in %d sweeps\n", p.radius.size(), p.sweeps);
}

TEST(Place, MassIsMetWithinHalfASphereAndFilledFromTheBottom) {
  scene::PackingFill fill = inside("box");
  fill.mass = 20;
  const scene::Scene scene = scene_with(fill, 0.01, {wall("box", scene::BoxShape{{0.3, 0.3, 0.6}, {"+z"}})});
  const Placement p = place(scene, 0, {}, {}, {}, 1);
  const double one = 7800 * scene::volume_of({0.01});
  EXPECT_NEAR(p.mass, 20, 0.5 * one);
  EXPECT_NEAR(p.mass, static_cast<double>(p.radius.size()) * one, 1e-9);
  EXPECT_LE(worst_pair(p), 1e-9);
  const double height = 20 / 7800.0 / 0.5 / 0.09;
  for (const Vec3d& x : p.position) {
    EXPECT_LE(std::abs(x.x), 0.14 + 1e-9);
    EXPECT_LE(std::abs(x.y), 0.14 + 1e-9);
    EXPECT_GE(x.z, -0.29 - 1e-9);
    EXPECT_LE(x.z, -0.3 + height - 0.01 + 1e-9);
  }
}

// The same scene, rotated and translated together with gravity.
TEST(Place, RotationOfTheWholeSceneRotatesThePacking) {
  const TriangleMesh ring = tandem::test::torus(0.2, 0.08, 40, 20);
  scene::PackingFill fill = inside("mesh");
  fill.count = 300;
  scene::Scene scene = scene_with(fill, 0.01, {wall("mesh", scene::MeshShape{"ring.stl"})});
  scene.gravity = {0, 0, -9.81};
  const Placement p = place(scene, 0, {{"mesh", ring}}, {}, {}, 1);
  const Pose pose{{3, -2, 1}, exp({0.7, -1.1, 0.4})};
  scene.gravity = pose.q_WB.rotate(scene.gravity);
  scene.dem->walls[0].pose = pose;
  const Placement rotated = place(scene, 0, {{"mesh", ring}}, {}, {}, 1);
  ASSERT_EQ(rotated.radius.size(), p.radius.size());
  double worst = 0;
  for (std::size_t i = 0; i < p.radius.size(); ++i) {
    EXPECT_EQ(rotated.radius[i], p.radius[i]);
    worst = std::max(worst, norm(rotated.position[i] - (pose.p_WB + pose.q_WB.rotate(p.position[i]))));
  }
  std::printf("largest difference %g m\n", worst);
  EXPECT_LE(worst, 1e-9);
}

TEST(Place, ResultDoesNotDependOnTheNumberOfThreads) {
  scene::PackingFill fill;
  fill.region = scene::CylinderRegion{{0, 0, 0}, {0.1, 0, 0.3}, 0.1};
  fill.void_fraction = 0.5;
  scene::Scene scene = scene_with(fill, 0.01, {});
  scene.dem->particles[0].radius_min = 0.004;
  const Placement one = place(scene, 0, {}, {}, {}, 1), three = place(scene, 0, {}, {}, {}, 3);
  EXPECT_EQ(one.position, three.position);
  EXPECT_EQ(one.radius, three.radius);
  EXPECT_LE(worst_pair(one), 1e-9);
  const Vec3d z = normalized(Vec3d{0.1, 0, 0.3});
  for (std::size_t i = 0; i < one.radius.size(); ++i) {
    const double along = dot(one.position[i], z), rho = norm(one.position[i] - along * z);
    EXPECT_LE(rho + one.radius[i], 0.1 + 1e-9);
    EXPECT_GE(along, one.radius[i] - 1e-9);
  }
}

// Closed walls in a region are solids, and open ones are sheets.
TEST(Place, RegionIsClippedAtWallsAndOtherSpheres) {
  scene::PackingFill fill;
  fill.region = scene::Box{{0, 0, 0}, {0.4, 0.3, 0.3}};
  fill.void_fraction = 0.55;
  Pose solid{{0.1, 0.1, 0.1}, exp({0.3, 0.2, 0.1})}, sheet{{0.3, 0.15, 0.15}, exp({0.4, 1.2, 0})};
  const scene::Scene scene = scene_with(fill, 0.012,
                                        {wall("solid", scene::BoxShape{{0.12, 0.1, 0.1}, {}}, ground, solid),
                                         wall("floor", scene::PlaneShape{{0, 0, 0.05}, {0, 0, 1}}),
                                         wall("sheet", scene::MeshShape{"sheet.stl"}, ground, sheet)});
  const TriangleMesh plate{{{-0.05, -0.05, 0}, {0.05, -0.05, 0}, {0, 0.05, 0}}, {{0, 1, 2}}};
  Fill others;
  others.position = {{0.2, 0.2, 0.2}};
  others.radius = {0.03};
  const Placement p = place(scene, 0, {{"sheet", plate}}, {}, others, 1);
  EXPECT_GT(p.radius.size(), 500u);
  EXPECT_LE(worst_pair(p), 1e-9);
  EXPECT_GE(least_gap(p, transformed(plate, sheet)), -1e-6);
  const TriangleMesh block = transformed(box_mesh({0.12, 0.1, 0.1}), solid);
  EXPECT_GE(least_gap(p, block), -1e-6);
  for (const Vec3d& x : p.position) {
    EXPECT_NEAR(winding_number(block, x), 0, 1e-6);
    EXPECT_GE(x.z, 0.05 + 0.012 - 1e-9);
    EXPECT_GE(norm(x - others.position[0]), 0.042 - 1e-9);
  }
}

TEST(Place, BedFollowsTheSurfaceBelow) {
  const TriangleMesh hill{{{0, 0, 0}, {1, 0, 0.2}, {1, 1, 0.2}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  scene::PackingFill fill;
  fill.region = scene::AboveWall{"hill", {{0.1, 0.2}}, {{0.9, 0.8}}, 0.15};
  const scene::Scene scene = scene_with(fill, 0.015, {wall("hill", scene::MeshShape{"hill.stl"})});
  const Placement p = place(scene, 0, {{"hill", hill}}, {}, {}, 1);
  EXPECT_NEAR(p.volume, 0.8 * 0.6 * 0.15, 1e-5);
  EXPECT_NEAR(p.void_fraction, 0.5, 0.005);
  EXPECT_LE(worst_pair(p), 1e-9);
  EXPECT_GE(least_gap(p, hill), -1e-6);
  for (const Vec3d& x : p.position) {
    EXPECT_GT(x.z, 0.2 * x.x);
    EXPECT_LE(x.z + 0.015, 0.2 * x.x + 0.15 + 1e-9);
  }
}

// A hopper: a cone that is open at both ends, below a round shell. Of regular polygons of n sides.
double polygon(int n, double radius) {
  return 0.5 * n * radius * radius * std::sin(2 * std::numbers::pi / n);
}
constexpr double mouth = 0.03, wide = 0.12, slope = 0.1;  // radii, and height of the cone [m]
TriangleMesh funnel() {
  return cone_mesh(mouth, wide, slope, 64, {"+z", "-z"});
}
std::vector<scene::Wall> hopper() {
  return {
      wall("cone", scene::MeshShape{"facets"}, ground, {{0, 0, 0.5 * slope}, {}}),
      wall("shell", scene::CylinderShape{wide, 0.2, {}, {"+z", "-z"}}, ground, {{0, 0, slope + 0.1}, {}})};
}

TEST(Place, RoomAboveAConeIsFilledToALevelAndNotBelowItsMouth) {
  scene::PackingFill fill;
  fill.region = scene::AboveWall{"cone"};
  fill.level = 0.2;
  const Placement p = place(scene_with(fill, 0.006, hopper()), 0, {{"cone", funnel()}}, {}, {}, 2);
  const double closed =
      slope / 3 *
          (polygon(64, mouth) + polygon(64, wide) + std::sqrt(polygon(64, mouth) * polygon(64, wide))) +
      0.1 * polygon(64, wide);
  std::printf("volume: expected %g m3, measured %g m3, tolerance 1e-3\n", closed, p.volume);
  EXPECT_NEAR(p.volume / closed, 1, 1e-3);
  EXPECT_LE(worst_pair(p), 1e-9);
  EXPECT_GE(least_gap(p, transformed(funnel(), {{0, 0, 0.5 * slope}, {}})), -1e-6);
  double low = 1;
  for (const Vec3d& x : p.position) {
    low = std::min(low, x.z);
    EXPECT_LE(x.z, 0.2 - 0.006 + 1e-9);
    EXPECT_LE(std::hypot(x.x, x.y), wide - 0.006 + 1e-9);
  }
  EXPECT_GT(low, 0);
  EXPECT_LT(low, 0.02) << "the mouth counts as closed, with room above it";
}

TEST(Place, MassAboveAConeIsFilledFromItsLowestPoint) {
  scene::PackingFill fill;
  fill.region = scene::AboveWall{"cone"};
  fill.level = 0.3;
  fill.mass = 2;
  fill.void_fraction = 0.6;
  const Placement p = place(scene_with(fill, 0.006, hopper()), 0, {{"cone", funnel()}}, {}, {}, 2);
  // The bed ends inside the cone, as high as its volume says, but for a layer at its top.
  const double grows = (wide - mouth) / slope, volume = fill.mass.value() / 7800.0 / 0.4,
               radius = std::cbrt(mouth * mouth * mouth + 3 * volume * grows / polygon(64, 1)),
               height = (radius - mouth) / grows;
  ASSERT_LT(radius, wide);
  double high = 0;
  for (const Vec3d& x : p.position) high = std::max(high, x.z);
  std::printf("top: expected %g m, measured %g m, tolerance 0.006 m\n", height, high + 0.006);
  EXPECT_NEAR(high + 0.006, height, 0.006);
  EXPECT_NEAR(p.void_fraction, 0.6, 0.1);
}

TEST(Place, ClosedWallsAroundTheRoomAboveAWallAreNoSolids) {
  scene::PackingFill fill;
  fill.region = scene::AboveWall{"cone"};
  fill.level = 0.2;
  fill.void_fraction = 0.7;
  std::vector<scene::Wall> walls = hopper();
  const Placement alone = place(scene_with(fill, 0.01, walls), 0, {{"cone", funnel()}}, {}, {}, 1);
  walls.push_back(wall("room", scene::BoxShape{{1, 1, 1}, {}}));
  const Placement p = place(scene_with(fill, 0.01, walls), 0, {{"cone", funnel()}}, {}, {}, 1);
  EXPECT_EQ(p.position, alone.position);
  // A wall that has a part of the room in it is a solid.
  walls.back() = wall("room", scene::BoxShape{{1, 1, 0.3}, {}});
  for (const Vec3d& x : place(scene_with(fill, 0.01, walls), 0, {{"cone", funnel()}}, {}, {}, 1).position)
    EXPECT_GE(x.z, 0.16 - 1e-9);
}

// A round plate: nothing but the end of the plate limits the bed.
TEST(Place, RoomAboveARoundPlateIsFilledDownToTheDocumentedVoidFraction) {
  for (const double void_fraction : {0.5, 0.42}) {
    SCOPED_TRACE(void_fraction);
    scene::PackingFill fill;
    fill.region = scene::AboveWall{"plate"};
    fill.level = 0.11;
    fill.void_fraction = void_fraction;
    const Placement p = place(
        scene_with(fill, 0.005, {wall("plate", scene::CylinderShape{0.1, 0.02, {}, {}})}), 0, {}, {}, {}, 2);
    std::printf("%zu spheres in %d sweeps\n", p.radius.size(), p.sweeps);
    EXPECT_NEAR(p.void_fraction, void_fraction, 1e-3);
    EXPECT_LE(worst_pair(p), 1e-9);
    for (const Vec3d& x : p.position) {
      EXPECT_LE(std::hypot(x.x, x.y), 0.095 + 1e-9);
      EXPECT_GE(x.z, 0.015 - 1e-9);
    }
  }
}

TEST(Place, RoomBetweenConeAndShellIsThatInsideOfBoth) {
  scene::PackingFill fill;
  fill.region = scene::BetweenWalls{{"cone", "shell"}};
  fill.level = 0.2;
  const Placement p = place(scene_with(fill, 0.006, hopper()), 0, {{"cone", funnel()}}, {}, {}, 2);
  const double round = std::numbers::pi * wide * wide,
               cone = slope / 3 * std::numbers::pi * (mouth * mouth + mouth * wide + wide * wide);
  std::printf("volume: expected %g m3, measured %g m3, tolerance 2e-3\n", cone + 0.1 * round, p.volume);
  EXPECT_NEAR(p.volume / (cone + 0.1 * round), 1, 2e-3);
  EXPECT_GE(least_gap(p, transformed(funnel(), {{0, 0, 0.5 * slope}, {}})), -1e-6);
  for (const Vec3d& x : p.position) EXPECT_GE(x.z, 0.006 - 1e-9) << "the sphere is wholly above the mouth";
}

// Two plates in the shape of a V with a slot, 0.3 m long: the prism between them.
TEST(Place, RoomBetweenTwoPlatesIsAPrism) {
  const TriangleMesh right{{{0.02, 0, 0}, {0.1, 0, 0.16}, {0.1, 0.3, 0.16}, {0.02, 0.3, 0}},
                           {{0, 1, 2}, {0, 2, 3}}};
  TriangleMesh left = right;
  for (Vec3d& v : left.vertices) v.x = -v.x;
  scene::PackingFill fill;
  fill.region = scene::BetweenWalls{{"left", "right"}};
  const std::vector<scene::Wall> plates{wall("left", scene::MeshShape{"l"}),
                                        wall("right", scene::MeshShape{"r"})};
  const Placement p =
      place(scene_with(fill, 0.008, plates), 0, {{"left", left}, {"right", right}}, {}, {}, 1);
  std::printf("volume: expected %g m3, measured %g m3, tolerance 1e-3\n", 0.16 * 0.12 * 0.3, p.volume);
  EXPECT_NEAR(p.volume / (0.16 * 0.12 * 0.3), 1, 1e-3);
  EXPECT_GE(least_gap(p, left), -1e-6);
  EXPECT_GE(least_gap(p, right), -1e-6);
  for (const Vec3d& x : p.position) {
    EXPECT_GE(x.y, 0.008 - 1e-9);
    EXPECT_LE(x.y, 0.292 + 1e-9);
    EXPECT_GE(x.z, 0.008 - 1e-9);
  }
  scene::PackingFill flat;
  flat.region = scene::BetweenWalls{{"left"}};
  EXPECT_THAT(refusal(scene_with(flat, 0.008, plates), {{"left", left}, {"right", right}}),
              HasSubstr("the walls lie in one plane"));
}

// Sizes from 1 to 10: the small ones fill the gaps.
TEST(Place, WideSieveCurveIsMetWithinOneSphereOfEachClass) {
  scene::PackingFill fill = inside("box");
  fill.void_fraction = 0.45;
  scene::Scene scene = scene_with(fill, 0.02, {wall("box", scene::BoxShape{{0.2, 0.2, 0.2}, {}})});
  scene::ParticleGroup& group = scene.dem->particles[0];
  const scene::SieveCurve curve{{0.006, 0.01, 0.02, 0.04}, {0, 0.1, 0.4, 1}};
  group.sizes = curve;
  scene::set_radius_limits(group);
  EXPECT_EQ(group.radius_min, 0.003);
  EXPECT_EQ(group.radius_max, 0.02);
  const Placement p = place(scene, 0, {}, {}, {}, 2);
  EXPECT_LE(worst_pair(p), 1e-9);
  const double all = scene::volume_of(p.radius);
  EXPECT_NEAR(1 - all / 0.008, 0.45, 0.0045);
  for (std::size_t k = 0; k < curve.size.size(); ++k) {
    std::vector<double> passing;
    std::ranges::copy_if(p.radius, std::back_inserter(passing),
                         [&](double r) { return 2 * r <= curve.size[k]; });
    const double largest = scene::volume_of({curve.size[k] / 2});
    EXPECT_NEAR(scene::volume_of(passing) / all, curve.passing[k], largest / all + 1e-3) << k;
  }
  std::printf("%zu spheres in %d sweeps\n", p.radius.size(), p.sweeps);
}

TEST(Place, WhatDoesNotFitIsRefused) {
  const scene::Wall box = wall("box", scene::BoxShape{{0.2, 0.2, 0.2}, {"+z"}});
  scene::PackingFill fill = inside("box");
  fill.mass = 100;
  EXPECT_THAT(refusal(scene_with(fill, 0.01, {box})),
              AllOf(HasSubstr("dem.particles[0].fill"), HasSubstr("kg do not fit: at a void fraction of 0.5"),
                    HasSubstr("holds 31.2 kg")));
  fill.mass = 1e-6;
  EXPECT_THAT(refusal(scene_with(fill, 0.01, {box})), HasSubstr("less than half a sphere"));
  fill.mass.reset();
  fill.void_fraction = 0.3;
  EXPECT_THAT(refusal(scene_with(fill, 0.03, {box})), HasSubstr("overlap each other or the walls"));
  fill.level = -0.2;
  EXPECT_THAT(refusal(scene_with(fill, 0.01, {box})), HasSubstr("the level of -0.2 m is below the region"));
  EXPECT_THAT(
      refusal(scene_with(inside("floor"), 0.01, {wall("floor", scene::PlaneShape{{0, 0, 0}, {0, 0, 1}})})),
      HasSubstr("'floor' does not end on all sides"));
  scene::PackingFill in_solid;
  in_solid.region = scene::AboveWall{"floor", {{-0.1, -0.1}}, {{0.1, 0.1}}, 0.1};
  EXPECT_THAT(refusal(scene_with(in_solid, 0.01, {wall("floor", scene::PlaneShape{{0, 0, 0}, {0, 0, 1}})})),
              HasSubstr("'floor' does not end on all sides"));
}

TEST(Place, OpenMeshIsFilledUpToItsOpeningsOnly) {
  const TriangleMesh cup = box_mesh({0.2, 0.2, 0.2}, {"+z"});
  scene::PackingFill fill = inside("cup");
  const std::vector<scene::Wall> walls{wall("cup", scene::MeshShape{"cup.stl"})};
  EXPECT_THAT(refusal(scene_with(fill, 0.01, walls), {{"cup", cup}}),
              AllOf(HasSubstr("open edges down to 0.1 m"), HasSubstr("give a level below")));
  fill.level = 0.05;
  const Placement p = place(scene_with(fill, 0.01, walls), 0, {{"cup", cup}}, {}, {}, 1);
  EXPECT_NEAR(p.volume, 0.2 * 0.2 * 0.15, 1e-6);
  EXPECT_GE(least_gap(p, cup), -1e-6);
  for (const Vec3d& x : p.position) EXPECT_LE(x.z, 0.04 + 1e-9);
}

scene::ParticleGroup sized(const scene::Sizes& sizes) {
  scene::ParticleGroup group;
  group.sizes = sizes;
  scene::set_radius_limits(group);
  return group;
}

TEST(Sizes, MassFractionsOfAListAreMetWithinOneSphere) {
  const scene::ParticleGroup group = sized(scene::ListedSizes{{0.01, 0.02}, {0.25, 0.75}});
  const double volume = 0.01;
  const std::vector<double> radii = scene::radii_of_volume(group, volume);
  const auto small = static_cast<double>(std::ranges::count(radii, 0.01));
  EXPECT_NEAR(small * scene::volume_of({0.01}), 0.25 * volume, scene::volume_of({0.01}));
  EXPECT_NEAR(scene::volume_of(radii), volume, 0.5 * scene::volume_of({0.02}));
}

// Moments of the cut distributions, by an integral of the densities.
TEST(Sizes, NormalAndLogNormalHaveTheirMomentsAndLimits) {
  for (const bool logarithmic : {false, true}) {
    const scene::Sizes sizes = logarithmic ? scene::Sizes(scene::LogNormalSizes{0.01, 0.004, 0.03, 0.4})
                                           : scene::Sizes(scene::NormalSizes{0.01, 0.003, 0.004, 0.03});
    const std::vector<double> radii = scene::radii_of_count(sized(sizes), 20000);
    ASSERT_EQ(radii.size(), 20000u);
    double all = 0, first = 0, third = 0;
    for (int k = 0; k < 200000; ++k) {
      const double r = 0.004 + 0.026 * (k + 0.5) / 200000;
      const double x = logarithmic ? std::log(r / 0.01) / 0.4 : (r - 0.01) / 0.003;
      const double density = std::exp(-x * x / 2) / (logarithmic ? r : 1);
      all += density;
      first += density * r;
      third += density * r * r * r;
    }
    double mean = 0, cube = 0;
    for (const double r : radii) {
      mean += r / 20000;
      cube += r * r * r / 20000;
      EXPECT_GE(r, 0.004);
      EXPECT_LE(r, 0.03);
    }
    EXPECT_NEAR(mean, first / all, 1e-4 * mean);
    EXPECT_NEAR(cube, third / all, 1e-3 * cube);
  }
}

}  // namespace
}  // namespace tandem::particles::test
