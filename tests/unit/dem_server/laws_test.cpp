// Contact laws against closed forms, through the engine, so that the tested code is the code that runs.
// Impacts with every variant are in tests/verification/dem.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "dem_server/laws/hertz.hpp"
#include "dem_server/laws/paper.hpp"
#include "tests/support/particle_run.hpp"

namespace tandem::test {
namespace {

// Spheres over a plane of the same material, without gravity.
std::string impact_scene(const std::string& law, double young, double poisson, double density,
                         double restitution, double friction, double radius, int count) {
  char text[2000];
  std::snprintf(text, sizeof text,
                R"({"tandem": "1.0", "name": "impact", "gravity": [0, 0, 0], "end_time": 1,
      "dem": {"contact": "%s", "precision": "double",
        "materials": [{"name": "m", "density": %.17g, "young": %.17g, "poisson": %.17g}],
        "pairs": [{"a": "m", "b": "m", "restitution": %.17g, "friction": %.17g,
                   "normal_stiffness": 1e9, "normal_damping": 0, "tangential_stiffness": 1e9, "tangential_damping": 0}],
        "particles": [{"name": "p", "material": "m", "radius": %.17g,
          "fill": {"type": "lattice", "min": [%.17g, %.17g, %.17g], "max": [%.17g, %.17g, %.17g], "spacing": %.17g, "count": %d}}],
        "walls": [{"name": "w", "material": "m", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
        "domain": {"min": [%.17g, %.17g, %.17g], "max": [%.17g, %.17g, %.17g]}}})",
                law.c_str(), density, young, poisson, restitution, friction, radius, -5 * radius, -5 * radius,
                2 * radius, 5 * radius, 5 * radius, 12 * radius, 3 * radius, count, -50 * radius,
                -50 * radius, -10 * radius, 50 * radius, 50 * radius, 90 * radius);
  return text;
}

void report(const char* what, double measured, double expected, double tolerance) {
  std::printf("%-44s expected %14.8g measured %14.8g error %9.2e tolerance %7.1e\n", what, expected, measured,
              std::abs(measured - expected) / std::abs(expected), tolerance);
  EXPECT_NEAR(measured, expected, tolerance * std::abs(expected)) << what;
}

// The paper's normal law without damping is Hertz's with a given stiffness: the deepest overlap follows from
// energy.
TEST(Paper, ElasticImpactReachesTheEnergyDepth) {
  const double R = 0.0025, v = 2, rho = 4000, k = 1e9;
  ParticleRun run(impact_scene("paper", 3.8e11, 0.23, rho, 1, 0.3, R, 1), particles::Backend::cpu, 1,
                  [&](particles::Spheres& s) {
                    s.position = {{0, 0, R}};
                    s.velocity = {{0, 0, -v}};
                  });
  for (int w = 0; w < 200; ++w) run.advance(500, 2e-9);
  const double mass = 4.0 / 3 * std::numbers::pi * rho * R * R * R;
  report("deepest overlap [m]", R * static_cast<double>(run.advance(1, 2e-9).window.max_overlap_ratio),
         std::pow(1.25 * mass * v * v / k, 0.4), 1e-3);
  report("speed after [m/s]", run.state().velocity[0].z, v, 1e-5);
}

// A sphere that slides on a plane under the paper's law starts to roll at 5/7 of its speed.
TEST(Paper, SlidingSphereEndsRollingAtFiveSevenths) {
  std::string json = impact_scene("paper", 1e8, 0.25, 2500, 1, 0.3, 0.01, 1);
  json.replace(json.find("[0, 0, 0]"), 9, "[0, 0, -9.81]");
  const double k = 1e9, mass = 4.0 / 3 * std::numbers::pi * 2500 * 1e-6;
  ParticleRun run(json, particles::Backend::cpu, 1, [&](particles::Spheres& s) {
    s.position = {{0, 0, 0.01 - std::pow(mass * 9.81 / k, 2.0 / 3)}};
    s.velocity = {{0.5, 0, 0}};
  });
  for (int w = 0; w < 100; ++w) run.advance(1000, 1e-6);
  report("rolling speed [m/s]", run.state().velocity[0].x, 0.5 * 5 / 7, 2e-3);
}

}  // namespace
}  // namespace tandem::test
