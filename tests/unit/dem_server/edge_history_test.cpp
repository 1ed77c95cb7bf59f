// The springs of friction and rolling resistance of a ball are kept across the bend between two patches.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "dem_server/laws/history.hpp"
#include "tests/unit/dem_server/contact_scene.hpp"

namespace tandem::test {
namespace {

// A floor along -x that falls off beyond the y axis by an angle above smooth_angle. Its far side is the
// wall's first patch, so that a contact has one name on the floor, and the other on the edge and beyond it.
TriangleMesh roof(double size) {
  const double bend = 40 * std::numbers::pi / 180;
  const double x = size * std::cos(bend), z = -size * std::sin(bend);
  return {{{0, -size, 0}, {0, size, 0}, {x, size, z}, {x, -size, z}, {-size, size, 0}, {-size, -size, 0}},
          {{0, 3, 2}, {0, 2, 1}, {0, 1, 4}, {0, 4, 5}}};
}

struct Held {
  Vec3d force;            // on the wall [N]
  Vec3d spring, rolled;   // [m] [rad]
  double twisted = 0;     // [rad]
  std::size_t entry = 0;  // list entry that holds the history
};

template <class Real>
Held held_by(ParticleRun& run, std::uint32_t steps, double dt) {
  Held held;
  held.force = run.advance(steps, dt).load.back().force;
  const Arrays arrays = written(run);
  const auto histories = array_of<dem::History<Real>>(arrays, "walls.history");
  for (std::size_t k = 0; k < histories.size(); ++k)
    if (histories[k].stamp > histories[held.entry].stamp) held.entry = k;
  held.spring = histories.at(held.entry).spring.template as<double>();
  if (const auto rolling = array_of<dem::RollingSpring<Real>>(arrays, "walls.rolling_spring");
      !rolling.empty()) {
    held.rolled = rolling.at(held.entry).rolled.template as<double>();
    held.twisted = static_cast<double>(rolling.at(held.entry).twisted);
  }
  return held;
}

void expect_the_same(const char* what, const Vec3d& measured, const Vec3d& expected) {
  std::printf("    %-22s expected %10.3e %10.3e %10.3e, differs by %.1e of it, tolerance 1e-3\n", what,
              expected.x, expected.y, expected.z, norm(measured - expected) / norm(expected));
  EXPECT_LT(norm(measured - expected), 1e-3 * norm(expected)) << what;
}

// The ball slips, rolls and twists by so little that all springs hold, and the edge is in the middle of its
// path of 1e-4 R. On a plane the same happens. A history lost at the edge would be half of the result.
template <class Real>
void expect_history_beyond_the_edge(const nlohmann::json& dem, double direction) {
  ContactScene plane;
  plane.dem = dem;
  plane.dem["precision"] = std::is_same_v<Real, float> ? "mixed" : "double";
  plane.constants = {{"restitution", 1}, {"friction", 10}, {"rolling_friction", 0.5}, {"rolling_damping", 0}};
  ContactScene bent = plane;
  bent.plane = false;
  bent.dem["walls"] = {
      {{"name", "w"}, {"material", "m"}, {"shape", {{"type", "mesh"}, {"file", "roof.stl"}}}}};

  const double R = plane.radius, dt = 1e-8;
  const auto start = [&](particles::Spheres& s) {
    s.position[0] = {-direction * 0.5e-4 * R, 0, R - 1e-3 * R};
    s.velocity[0] = {direction, 0.5, 0};
    s.spin[0] = {direction * 10, direction * 20, 30};
  };
  ParticleRun on_plane(plane.json(), particles::Backend::cpu, 1, start),
      on_bend(bent.json(), particles::Backend::cpu, 1, start, {{"w", roof(10 * R)}});
  Held before = held_by<Real>(on_bend, 49, dt), flat = held_by<Real>(on_plane, 49, dt);
  expect_the_same("spring before [m]", before.spring, flat.spring);
  const Held after = held_by<Real>(on_bend, 51, dt);
  flat = held_by<Real>(on_plane, 51, dt);
  EXPECT_NE(after.entry, before.entry) << "the other patch has it";
  expect_the_same("force beyond [N]", after.force, flat.force);
  expect_the_same("spring beyond [m]", after.spring, flat.spring);
  if (!dem.contains("rolling")) return;
  expect_the_same("rolled beyond [rad]", after.rolled, flat.rolled);
  expect_close("twisted beyond [rad]", after.twisted, flat.twisted, 1e-3);
}

TEST(EdgeHistory, GoesOnBeyondTheEdge) {
  for (const double direction : {1.0, -1.0}) {
    std::printf("  %s, mixed, double:\n", direction > 0 ? "down" : "up");
    expect_history_beyond_the_edge<float>(nlohmann::json::object(), direction);
    expect_history_beyond_the_edge<double>(nlohmann::json::object(), direction);
  }
}

TEST(EdgeHistory, TurningSpringsGoOnBeyondTheEdge) {
  const nlohmann::json moments = {{"rolling", "elastic_plastic"}, {"twisting", "elastic_plastic"}};
  for (const double direction : {1.0, -1.0}) {
    std::printf("  %s, mixed, double:\n", direction > 0 ? "down" : "up");
    expect_history_beyond_the_edge<float>(moments, direction);
    expect_history_beyond_the_edge<double>(moments, direction);
  }
}

}  // namespace
}  // namespace tandem::test
