// Groups of spheres that never move are walls of the ground, each sphere a patch of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/solver_run.hpp"
#include "tests/unit/dem_geometry/walls.hpp"
#include "tests/unit/dem_server/contact_scene.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;

// A group of one fixed sphere at this position.
json fixed_sphere(const std::string& name, Vec3d at, double radius) {
  const double half = radius * (1 + 1e-9);
  return {{"name", name},
          {"material", "m"},
          {"radius", radius},
          {"fixed", true},
          {"fill",
           {{"type", "lattice"},
            {"min", {at.x - half, at.y - half, at.z - half}},
            {"max", {at.x + half, at.y + half, at.z + half}},
            {"spacing", 2 * radius},
            {"count", 1}}}};
}

struct Hollow {
  ContactScene scene;
  double R = scene.radius, across = 2 * R / std::sqrt(3.0);  // from the axis to the three centres [m]
  double overlap = 0, height = 0;                            // at rest, above the three centres [m]

  explicit Hollow(double friction) {
    scene.plane = false;
    scene.gravity = {0, 0, -9.81};
    scene.constants = {{"restitution", 0.05}, {"friction", friction}};
    // 3 k overlap^(3/2) height / distance = m g, k = 4/3 E* sqrt(R / 2).
    const double k = 4.0 / 3 * scene.e_star() * std::sqrt(R / 2);
    for (int i = 0; i < 100; ++i) {
      const double distance = 2 * R - overlap;
      height = std::sqrt(distance * distance - across * across);
      overlap = std::pow(scene.mass() * 9.81 * distance / (3 * k * height), 2.0 / 3);
    }
  }
  json dem() const {
    json all = json::parse(scene.json());
    for (int i = 0; i < 3; ++i) {
      const double angle = 2 * std::numbers::pi * i / 3;
      all["dem"]["particles"].push_back(
          fixed_sphere("f" + std::to_string(i), across * Vec3d{std::cos(angle), std::sin(angle), 0}, R));
    }
    return all;
  }
};

TEST(FixedSpheres, CarryASphereInTheHollowBetweenThree) {
  for (const double friction : {0.0, 0.5}) {
    const Hollow hollow(friction);
    // Without friction it moves to its equilibrium, with friction it stays there.
    const Vec3d offset = friction > 0 ? Vec3d{} : hollow.R * Vec3d{0.003, -0.002, 0.01};
    ParticleRun run(hollow.dem().dump(), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
      s.position[0] = Vec3d{0, 0, hollow.height} + offset;
    });
    ASSERT_EQ(run.spheres.size(), 1u);
    ASSERT_EQ(run.surface.facets.size(), 3u);
    const double dt = 2e-6, weight = hollow.scene.mass() * 9.81;
    for (int w = 0; w < 50; ++w) run.advance(1000, dt);
    const Wrench load = run.advance(1, dt).load.at(0);
    const Vec3d x = run.state().position[0];
    std::printf("friction %.1f, overlap %.4g R\n", friction, hollow.overlap / hollow.R);
    expect_close("height [m]", x.z, hollow.height, 1e-9);
    expect_close("load on the ground over the weight", -load.force.z / weight, 1, 1e-6);
    EXPECT_LT(std::hypot(load.force.x, load.force.y), 1e-6 * weight);
    EXPECT_LT(std::hypot(x.x, x.y), 1e-8 * hollow.R);
    EXPECT_EQ(dem::test::contacts(run.surface, x, hollow.R).size(), 3u);
    // Each has the overlap of the closed form.
    for (const particles::WallContact& contact : dem::test::contacts(run.surface, x, hollow.R))
      EXPECT_NEAR(-contact.gap, hollow.overlap, 1e-4 * hollow.overlap);
  }
}

// Two adjacent spheres of a floor both count, however deep the sphere is in one of them, within the range of
// Hertz's law.
TEST(FixedSpheres, NeighboursDoNotCoverEachOther) {
  const double R = 1;
  for (const double B : {0.2, 0.5, 1.0, 3.0}) {
    scene::Scene scene = dem::test::empty_scene();
    scene.dem->particles.resize(1);
    const std::vector<particles::FixedSphere> pair{{{-B, 0, 0}, B, 0, 0}, {{B, 0, 0}, B, 0, 0}};
    const particles::Surface s = particles::make_surface(scene, {}, 1.5 * R, pair);
    // Overlaps of 5 % and of 0.1 % of the smaller radius.
    const double smaller = std::min(R, B), deep = 0.05 * smaller, shallow = 0.001 * smaller;
    const double a = R + B - deep, b = R + B - shallow;
    const double x = (a * a - b * b) / (4 * B), z = std::sqrt(a * a - (x + B) * (x + B));
    EXPECT_EQ(dem::test::contacts(s, {x, 0, z}, R).size(), 2u) << B;
    EXPECT_EQ(dem::test::contacts(s, {0, 0, std::sqrt(a * a - B * B)}, R).size(), 2u) << B;
  }
}

// A sphere rolls on a floor of fixed spheres through a periodic face as on an infinite floor.
TEST(FixedSpheres, GoOnBeyondPeriodicFaces) {
  const auto scene_of = [](int count, bool periodic) {
    ContactScene scene;
    const double R = scene.radius, B = 0.8 * R, length = 2 * B * count;
    scene.plane = false;
    scene.gravity = {0, 0, -9.81};
    scene.constants = {{"restitution", 0.5}, {"friction", 0.4}};
    scene.dem = {{"variant", "generic"}};
    json all = json::parse(scene.json());
    json domain = {{"min", {0, -5 * R, -5 * R}}, {"max", {length, 5 * R, 20 * R}}};
    if (periodic) domain["periodic"] = {"x"};
    all["dem"]["domain"] = domain;
    all["dem"]["particles"][0]["fill"]["min"] = {0, -2 * R, 2 * R};
    all["dem"]["particles"][0]["fill"]["max"] = {4 * R, 2 * R, 10 * R};
    // Two rows, between which it rolls.
    for (int i = 0; i < count; ++i)
      for (const double y : {-0.8, 0.8})
        all["dem"]["particles"].push_back(
            fixed_sphere("f" + std::to_string(i) + (y < 0 ? "a" : "b"), {(2 * i + 1) * B, y * R, 0}, B));
    return all.dump();
  };
  const double R = ContactScene{}.radius, B = 0.8 * R, period = 2 * B * 8;
  const auto start = [&](particles::Spheres& s) {
    s.position[0] = {B, 0, 1.65 * R};
    s.velocity[0] = {1.5, 0, 0};
  };
  ParticleRun endless(scene_of(40, false), particles::Backend::cpu, 1, start),
      periodic(scene_of(8, true), particles::Backend::cpu, 1, start);
  double worst = 0;
  for (int w = 0; w < 200; ++w) {
    endless.advance(100, 1e-5);
    periodic.advance(100, 1e-5);
    Vec3d apart = endless.state().position[0] - periodic.state().position[0];
    apart.x -= std::round(apart.x / period) * period;
    worst = std::max(worst, norm(apart));
  }
  const double travelled = endless.state().position[0].x;
  std::printf("  travelled %.3g periods; apart by at most %.2e R, tolerance 1e-6\n", travelled / period,
              worst / R);
  EXPECT_GT(travelled, 1.3 * period);
  EXPECT_LT(worst, 1e-6 * R);
}

// Two images of one sphere are one patch.
TEST(FixedSpheres, WhoseImagesASphereCouldTouchAtOnceAreRefused) {
  scene::Dem dem;
  dem.domain = {{0, -1, 0}, {0.048, 1, 1}};
  dem.periodic[0] = true;
  const std::vector<particles::FixedSphere> spheres{{{}, 0.01, 0, 3}, {{0.02, 0, 0}, 0.0175, 0, 4}};
  EXPECT_NO_THROW(particles::expect_single_images(spheres, dem, 0.0064));
  EXPECT_EQ(
      error_of([&] { particles::expect_single_images(spheres, dem, 0.0066); }),
      "scene: dem.particles[4]: a fixed sphere of radius 0.0175 m in a domain of 0.048 m along the periodic "
      "axis x: one "
      "of radius 0.0066 m could touch two of its images at once (use smaller ones, or a period of at least "
      "0.0482 m)");
}

TEST(FixedSpheres, ThatOverlapOthersAtTheStartAreRefusedOrMakeRoom) {
  const Hollow hollow(0.5);
  json all = hollow.dem();
  const double R = hollow.R;
  all["dem"]["particles"][0]["fill"] = {{"type", "lattice"},
                                        {"min", {-R, -R, hollow.height - 1.05 * R}},
                                        {"max", {1.01 * R, 1.01 * R, hollow.height + R}},
                                        {"spacing", 2 * R},
                                        {"count", 1}};
  const scene::Scene scene = scene::parse(all.dump(), "test");
  particles::Fill fill = particles::make_fill(scene, {});
  const particles::Surface surface =
      particles::make_surface(scene, {}, 1.5 * R, particles::make_fixed(scene, {}));
  ASSERT_EQ(fill.position.size(), 1u);
  std::string message;
  try {
    particles::check_start(fill, surface, scene);
  } catch (const Error& error) {
    message = error.what();
  }
  EXPECT_THAT(message, HasSubstr("overlaps a fixed sphere of 'f"));
  EXPECT_EQ(particles::relax_start(fill, surface, scene).moved, 1u);
  particles::check_start(fill, surface, scene);
}

TEST(FixedSpheres, AreNoSpheresOfTheRun) {
  const Hollow hollow(0.5);
  json all = hollow.dem();
  all["coupling"] = {{"window", 1e-3}};
  const double R = hollow.R, z = hollow.height;
  all["dem"]["particles"][0]["fill"] = {{"type", "lattice"},
                                        {"min", {-R, -R, z - R}},
                                        {"max", {1.01 * R, 1.01 * R, z + 2 * R}},
                                        {"spacing", 2 * R},
                                        {"count", 1}};
  SolverRun run(all, "test", 1, "cpu");
  EXPECT_EQ(run.configured["spheres"], 1);
  EXPECT_THAT(run.configured["left_out"].get<std::vector<std::string>>(),
              Contains("spheres that never move: 3 fixed ones are walls of the ground"));
  for (int w = 0; w < 100; ++w) run.advance_window({});
  EXPECT_LT(norm(run.open), 1e-9 * run.exchanged);
  EXPECT_EQ(run.lost, 0u);
}

}  // namespace
}  // namespace tandem::test
