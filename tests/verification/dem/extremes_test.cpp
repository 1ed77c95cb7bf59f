// Extreme sizes, masses, speeds and stiffnesses, with the error of each case against a closed form; the table
// is in docs/contact_laws.md. Triangles far larger or smaller than a sphere are in tessellation_test.cpp, a
// light plate in heavy grains is in tests/verification/coupling/gallery_test.cpp.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include "common/error.hpp"
#include "particles/state/particles.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/tested_backend.hpp"
#include "tests/verification/dem/impact.hpp"

namespace tandem::test {
namespace extremes_test {

// Both precisions of the pair arithmetic, with the same law.
struct Precision {
  const char *name, *options;
};
constexpr Precision precisions[] = {{"mixed", ""}, {"double", R"("precision": "double",)"}};

void row(const std::string& what, const char* precision, double error, double tolerance) {
  std::printf("  %-52s %-7s error %.1e, tolerance %.0e\n", what.c_str(), precision, error, tolerance);
  EXPECT_LT(error, tolerance) << what << ", " << precision;
}

constexpr double restitution = 0.8, poisson = 0.25;

// Two spheres without friction that collide head on at `speed`; the first one is at rest.
struct Pair {
  double radius[2], density[2];  // [m] [kg/m3]
  double speed;                  // [m/s]
  double young = 1e9;            // [Pa]

  double mass(int i) const { return 4.0 / 3 * std::numbers::pi * density[i] * std::pow(radius[i], 3); }
  double reduced_mass() const { return mass(0) * mass(1) / (mass(0) + mass(1)); }
  // Of an elastic Hertz contact [s].
  double duration() const {
    const double r = radius[0] * radius[1] / (radius[0] + radius[1]),
                 k = 4.0 / 3 * young / (2 * (1 - poisson * poisson)) * std::sqrt(r);
    return 2.9432 * std::pow(1.25 * reduced_mass() * speed * speed / k, 0.4) / speed;
  }
  std::string json(const char* options) const {
    return fmt::format(
        R"({{"tandem": "1.0", "name": "pair", "gravity": [0, 0, 0], "end_time": 1, "dem": {{{0}
          "contact": "hertz_frictionless",
          "materials": [{{"name": "a", "density": {1}, "young": {3}, "poisson": {4}}},
                        {{"name": "b", "density": {2}, "young": {3}, "poisson": {4}}}],
          "pairs": [{{"a": "a", "b": "a", "restitution": {5}}}, {{"a": "a", "b": "b", "restitution": {5}}},
                    {{"a": "b", "b": "b", "restitution": {5}}}],
          "particles": [{{"name": "p", "material": "a", "radius": {6},
             "fill": {{"type": "lattice", "min": [-0.1, -0.1, -0.1], "max": [0.1, 0.1, 0.1], "spacing": 0.05, "count": 2}}}}],
          "domain": {{"min": [-0.2, -0.2, -0.2], "max": [0.2, 0.2, 0.2]}}}}}})",
        options, density[0], density[1], young, poisson, restitution, std::max(radius[0], radius[1]));
  }
};

// The larger error of both velocities after the impact, relative to the change of velocity of each.
double error_of(const Pair& pair, const char* options) {
  const double gap = 1e-3 * std::min(pair.radius[0], pair.radius[1]);
  ParticleRun run(pair.json(options), tested_backend(), 1, [&](particles::Spheres& s) {
    s.radius = {pair.radius[0], pair.radius[1]};
    s.material = {0, 1};
    s.position = {{0.1, 0, 0}, {0.1 + pair.radius[0] + pair.radius[1] + gap, 0, 0}};
    s.velocity = {{}, {-pair.speed, 0, 0}};
  });
  const double dt = pair.duration() / 1000;
  particles::Spheres now;
  for (int i = 0; i < 1000; ++i) {
    run.advance(100, dt);
    now = run.state();
    if (now.position[1].x - now.position[0].x > pair.radius[0] + pair.radius[1] + gap) break;
  }
  double worst = 0;
  for (int i = 0; i < 2; ++i) {
    const double change =
                     (i == 0 ? -1 : 1) * (1 + restitution) * pair.speed * pair.reduced_mass() / pair.mass(i),
                 begin = i == 0 ? 0 : -pair.speed;
    worst = std::max(worst, std::abs(now.velocity[i].x - begin - change) / std::abs(change));
  }
  return worst;
}

TEST(Extremes, SizesMassesAndSpeedsFarApart) {
  for (const auto& [name, options] : precisions) {
    row("sizes 1:100, small on large, 1 m/s", name, error_of({{1e-2, 1e-4}, {2500, 2500}, 1}, options), 1e-3);
    row("sizes 1:100, large on small, 1 m/s", name, error_of({{1e-4, 1e-2}, {2500, 2500}, 1}, options), 1e-3);
    row("masses 1:1e6, equal sizes, light on heavy", name, error_of({{1e-2, 1e-2}, {2.5e6, 2.5}, 1}, options),
        1e-3);
    row("masses 1:1e6, equal sizes, heavy on light", name, error_of({{1e-2, 1e-2}, {2.5, 2.5e6}, 1}, options),
        1e-3);
    row("two glass spheres at 1000 m/s", name, error_of({{1e-2, 1e-2}, {2500, 2500}, 1000, 7e10}, options),
        1e-3);
  }
}

TEST(Extremes, HardSphereOnAWall) {
  for (const auto& [name, options] : precisions) {
    const Variant variant{name, "hertz_mindlin", options, true};
    const Ball ball{1e11, 0.3, 7850, 0.9, 0, 5e-3};
    for (const double v : {1e-3, 1.0, 10.0}) {
      const Rebound r = impact_on_plane(variant, ball, {0, 0, -v}, {});
      row(fmt::format("E = 1e11 Pa, {} m/s on a wall: restitution", v), name,
          std::abs(r.velocity.z / v - ball.restitution), 1e-3);
    }
  }
}

// With a hard material the impact follows Hertz's law. With a softer one the overlap leaves the range of the
// law, and the run ends with an error.
TEST(Extremes, ThousandMetresPerSecondOnAWall) {
  constexpr double v = 1000;
  const Ball hard{1e14, 0.3, 2500, 0.9, 0, 5e-3}, glass{7e10, 0.3, 2500, 0.9, 0, 5e-3};
  for (const auto& [name, options] : precisions) {
    const Variant variant{name, "hertz_mindlin", options, true};
    const Rebound r = impact_on_plane(variant, hard, {0, 0, -v}, {});
    row(fmt::format("1000 m/s on a wall, overlap {:.2f} R: restitution", r.deepest / hard.radius), name,
        std::abs(r.velocity.z / v - hard.restitution), 1e-3);
    try {
      impact_on_plane(variant, glass, {0, 0, -v}, {});
      ADD_FAILURE() << "an overlap of " << glass.deepest_on_plane(v) / glass.radius << " radii went through";
    } catch (const Error& error) {
      std::printf("  1000 m/s of glass on a wall, %.2f R by Hertz: %s\n",
                  glass.deepest_on_plane(v) / glass.radius, error.what());
      EXPECT_EQ(error.code(), ErrorCode::numerics);
    }
  }
}

// A plate that is thinner than the overlap reflects a sphere like a plane, with the step that the solver
// chooses.
TEST(Extremes, ThinPlateIsNotTunnelled) {
  const Ball glass{7e10, 0.3, 2500, 0.9, 0, 5e-3};
  const double R = glass.radius;
  for (const auto& [name, options] : precisions) {
    const Variant variant{name, "hertz_mindlin", options, true};
    const std::string plate = fmt::format(
        R"({{"name": "plate", "material": "rigid", "position": [0, 0, {0}],
             "shape": {{"type": "box", "size": [{1}, {1}, {2}]}}}})",
        -0.01 * R, 20 * R, 0.02 * R);
    const std::string on_plate = impact_scene(variant, glass, 1, plate),
                      on_plane = impact_scene(variant, glass, 1, rigid_plane);
    const double step = 0.2 * std::numbers::pi * R *
                        std::sqrt(glass.density * 2 * (1 + glass.poisson) / glass.young) /
                        (0.1631 * glass.poisson + 0.8766);
    for (const double v : {1.0, 10.0, 100.0}) {
      const int steps = static_cast<int>(glass.duration_on_plane(v) / step);
      const Rebound thin = impact_on_walls(on_plate, {}, glass, {}, {0, 0, -v}, {}, steps),
                    thick = impact_on_walls(on_plane, {}, glass, {}, {0, 0, -v}, {}, steps);
      row(fmt::format("plate of 0.02 R, {} m/s, overlap {:.3f} R, {} steps", v, thick.deepest / R, steps),
          name, std::abs(thin.velocity.z - thick.velocity.z) / v, 1e-6);
      EXPECT_NEAR(thick.velocity.z / v, glass.restitution, 0.02) << "at so few steps";
    }
  }
}

// A box of small spheres, and one more sphere that may overlap them.
std::string heap_json(double second_at, double gravity, const char* options = "") {
  return fmt::format(
      R"({{"tandem": "1.0", "name": "heap", "gravity": [0, 0, {}], "end_time": 1, "dem": {{{}
        "materials": [{{"name": "m", "density": 2500, "young": 1e7, "poisson": 0.25}}],
        "pairs": [{{"a": "m", "b": "m", "restitution": 0.3, "friction": 0.4,
                    "rolling_friction": 0.05, "rolling_damping": 0.3}}],
        "particles": [
          {{"name": "p", "material": "m", "radius": 0.01,
            "fill": {{"type": "lattice", "min": [0, 0, 0], "max": [0.0845, 0.0845, 0.0845], "spacing": 0.021}}}},
          {{"name": "q", "material": "m", "radius": 0.01,
            "fill": {{"type": "lattice", "min": [{}, 0, 0], "max": [0.2, 0.021, 0.021], "spacing": 0.021,
                      "count": 1}}}}],
        "walls": [{{"name": "box", "material": "m", "position": [0.0425, 0.0425, 0.1],
                    "shape": {{"type": "box", "size": [0.085, 0.085, 0.2], "open": ["+z"]}}}}],
        "domain": {{"min": [-0.2, -0.2, -0.2], "max": [0.4, 0.4, 0.4]}}}}}})",
      gravity, options, second_at);
}

// Spheres within rings of bodies; some rings have more bodies than Label can count. Each body exchanges
// momentum with its sphere, and contacts survive rebuilds of the lists.
TEST(Extremes, SpheresAmongFortyBodies) {
  constexpr int rings[] = {particles::Label::counted - 1, particles::Label::counted,
                           particles::Label::counted + 1, 40};
  constexpr double radius = 0.2, knob = 0.01, slope = 0.8, overlap = 1e-4, spacing = 0.6, dt = 1e-6;
  constexpr std::uint32_t steps = 300;
  for (const Precision& precision : precisions) {
    const auto run_with = [&](const char* skin) {
      std::string walls, bodies;
      for (int ring = 0; ring < 4; ++ring)
        for (int b = 0; b < rings[ring]; ++b) {
          const double angle = 2 * std::numbers::pi * b / rings[ring], away = radius + knob - overlap;
          const char* comma = walls.empty() ? "" : ", ";
          walls += fmt::format(
              R"({}{{"name": "w{}_{}", "body": "b{}_{}", "material": "m", "shape": {{"type": "sphere", "radius": {}}}}})",
              comma, ring, b, ring, b, knob);
          bodies += fmt::format(
              R"({}{{"name": "b{}_{}", "mass": 1, "inertia": [1, 1, 1], "position": [{}, {}, {}]}})", comma,
              ring, b, ring * spacing + away * std::sin(slope) * std::cos(angle),
              away * std::sin(slope) * std::sin(angle), -away * std::cos(slope));
        }
      return std::make_unique<ParticleRun>(
          fmt::format(
              R"({{"tandem": "1.0", "name": "rings", "gravity": [0, 0, 0], "end_time": 1, "dem": {{{}{}
            "contact": "hertz_mindlin",
            "materials": [{{"name": "m", "density": 2500, "young": 1e8, "poisson": 0.25, "restitution": 0.5, "friction": 0.4}}],
            "particles": [{{"name": "p", "material": "m", "radius": {},
               "fill": {{"type": "lattice", "min": [-0.3, -0.3, -0.3], "max": [2.1, 0.3, 0.3], "spacing": 0.5, "count": 4}}}}],
            "domain": {{"min": [-1, -1, -1], "max": [3, 1, 1]}}, "walls": [{}]}}, "mbd": {{"bodies": [{}]}}}})",
              precision.options, skin, radius, walls, bodies),
          tested_backend(), 1, [&](particles::Spheres& s) {
            for (int ring = 0; ring < 4; ++ring) {
              const auto i = static_cast<std::size_t>(ring);
              s.position[i] = {ring * spacing, 0, 0};
              s.velocity[i] = {0.1 * (ring - 1), 0.2, -0.3};
              s.spin[i] = {1, -2, 3};
            }
          });
    };
    const auto run = run_with(R"("skin": 2e-5,)"), seldom = run_with(R"("skin": 0.01,)");
    const particles::Spheres begin = run->state();
    const dem::WindowOutcome& o = run->advance(steps, dt);
    EXPECT_GT(o.window.rebuilds, 3u);
    EXPECT_EQ(o.window.near, 31u + 30u + 32u + 40u);
    EXPECT_EQ(seldom->advance(steps, dt).window.rebuilds, 1u);
    const particles::Spheres end = run->state(), expected = seldom->state();
    const double mass = o.end.mass / 4;
    double momentum = 0, apart = 0;
    std::size_t body = 1;  // after the ground
    for (std::size_t ring = 0; ring < 4; ++ring) {
      Vec3d given;
      for (const std::size_t last = body + static_cast<std::size_t>(rings[ring]); body < last; ++body)
        for (std::size_t step = 0; step < steps; ++step)
          given += dt * o.load[step * run->surface.boundary_bodies.size() + body].force;
      const Vec3d gained = mass * (end.velocity[ring] - begin.velocity[ring]);
      momentum = std::max(momentum, norm(gained + given) / norm(given));
      apart =
          std::max({apart, norm(end.velocity[ring] - expected.velocity[ring]) / norm(end.velocity[ring]),
                    norm(end.spin[ring] - expected.spin[ring]) / norm(end.spin[ring] - begin.spin[ring])});
    }
    row("spheres among 30 to 40 bodies: momentum", precision.name, momentum, 1e-11);
    row("the same, with lists built once or often", precision.name, apart, 1e-9);
  }
}

TEST(Extremes, OverlappingStartIsRefusedWithItsWorstPair) {
  // The first sphere of the second group starts half a radius inside the fourth of the first.
  const scene::Scene scene = scene::parse(heap_json(0.063 + 0.015, -9.81), "test");
  const particles::Fill fill = particles::make_fill(scene, {});
  const particles::Surface surface = particles::make_surface(scene, {}, 0.0125);
  try {
    particles::check_start(fill, surface, scene);
    FAIL() << "it was accepted";
  } catch (const Error& error) {
    std::printf("  overlapping start: %s\n", error.what());
    EXPECT_EQ(error.code(), ErrorCode::scene);
    EXPECT_NE(error.problem().find("50 % of the radius"), std::string::npos) << error.problem();
  }
}

// The sphere is removed, its momentum is recorded as lost, and the run continues.
TEST(Extremes, SphereThrownOutOfTheDomain) {
  ParticleRun run(heap_json(0.12, 0), tested_backend(), 1, [](particles::Spheres& s) {
    s.velocity.back() = {0, 0, 300};
  });
  const double mass = 4.0 / 3 * std::numbers::pi * 2500 * 1e-6;
  const std::size_t before = run.spheres.size();
  Vec3d carried;
  std::uint64_t lost = 0;
  for (int w = 0; w < 20; ++w) {
    const dem::WindowOutcome& o = run.advance(100, 1e-6);
    carried += o.lost_momentum;
    lost = o.window.lost;
  }
  EXPECT_EQ(lost, 1u);
  EXPECT_EQ(run.state().size(), before - 1);
  row("thrown out at 300 m/s: momentum recorded as lost", "mixed", std::abs(carried.z / (300 * mass) - 1),
      1e-6);
}

// A bed at rest stays where it is: four layers of 16 spheres in a box that just holds them.
TEST(Extremes, RestingBedStaysAtRest) {
  constexpr double dt = 2e-5;
  // Without rolling and twisting resistance a sphere may roll, or rotate about the vertical, for ever.
  std::string json =
      heap_json(0.12, -9.81, R"("rolling": "elastic_plastic", "twisting": "elastic_plastic",)");
  const auto put = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(json.find(from), std::string::npos);
    json.replace(json.find(from), from.size(), to);
  };
  put("[0.085, 0.085, 0.2]", "[0.0839, 0.0839, 0.2]");
  ParticleRun run(json, tested_backend(), 1, [](particles::Spheres& s) {
    for (auto* v : {&s.position, &s.velocity, &s.spin}) v->pop_back();
    s.radius.pop_back();
    s.material.pop_back();
    s.id.pop_back();
    // The spheres are close to each other and slightly displaced, so that nothing is symmetric.
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double k = static_cast<double>(i);
      s.position[i] += 3e-4 * Vec3d{std::sin(3 * k), std::sin(5 * k), 0};
    }
  });
  const auto energy_per_sphere = [&](std::uint32_t steps) {
    double energy = 0;
    for (std::uint32_t done = 0; done < steps; done += 1000)
      energy = run.advance(1000, dt).end.kinetic_energy / static_cast<double>(run.spheres.size());
    return energy;
  };
  const double settled = energy_per_sphere(100000);
  const particles::Spheres begin = run.state();
  const double end = energy_per_sphere(100000), moved = largest_distance(begin, run.state());
  const double lift = 4.0 / 3 * std::numbers::pi * 2500 * 1e-6 * 9.81 * 0.01;  // by a radius [J]
  std::printf(
      "  %zu spheres at rest for 100,000 steps: kinetic energy per sphere %.1e J, then %.1e J (a lift by a "
      "radius: %.1e J); moved %.1e m\n",
      begin.size(), settled, end, lift, moved);
  EXPECT_LT(end, 1e-9 * lift);
  EXPECT_LE(end, std::max(settled, 1e-12 * lift));
  EXPECT_LT(moved, 1e-3 * 0.01);
}

}  // namespace extremes_test
}  // namespace tandem::test
