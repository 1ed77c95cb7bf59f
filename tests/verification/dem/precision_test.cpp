// Cases where single precision of absolute coordinates fails: far from the origin, where the resolution of a
// coordinate is coarser than an overlap, and in creep, where the motion of a step is less than the
// resolution. Both precisions of the solver are compared with an emulation that keeps position and velocity
// in float, or in double to verify the emulation. docs/experiments/2026-11-precision.md has the table.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "tests/support/particle_run.hpp"
#include "tests/support/tested_backend.hpp"

namespace tandem::test {
namespace precision_test {

constexpr double R = 0.01, density = 2500, young = 1e9, poisson = 0.25,
                 restitution = 0.8;  // [m] [kg/m3] [Pa]
constexpr double gap = 1e-4 * R;
const double mass = 4.0 / 3 * std::numbers::pi * density * R * R * R;
const double stiffness =
    4.0 / 3 * young / (2 * (1 - poisson * poisson)) * std::sqrt(R / 2);  // Hertz [N/m^1.5]

std::string pair_json(const char* options, double at) {
  return fmt::format(
      R"({{"tandem": "1.0", "name": "pair", "gravity": [0, 0, 0], "end_time": 1, "dem": {{{0}
        "contact": "hertz_frictionless",
        "materials": [{{"name": "m", "density": {1}, "young": {2}, "poisson": {3}}}],
        "pairs": [{{"a": "m", "b": "m", "restitution": {4}}}],
        "particles": [{{"name": "p", "material": "m", "radius": {5},
          "fill": {{"type": "lattice", "min": [{6}, -0.1, -0.1], "max": [{7}, 0.1, 0.1], "spacing": 0.05,
                    "count": 2}}}}],
        "domain": {{"min": [{6}, -0.2, -0.2], "max": [{7}, 0.2, 0.2]}}}}}})",
      options, density, young, poisson, restitution, R, at - 0.2, at + 0.2);
}

// Two equal spheres that collide head on at a distance from the origin.
struct Collision {
  double at, speed;  // [m]; relative speed [m/s]

  // Of an elastic Hertz contact [m].
  double deepest() const { return std::pow(1.25 * mass / 2 * speed * speed / stiffness, 0.4); }
  double dt() const { return 2.9432 * deepest() / speed / 1000; }
  static constexpr int steps = 4000;  // four contact durations
};

// |u'/u - e| with the relative speeds u before and u' after the collision.
double error_of_solver(const Collision& m, const char* options) {
  ParticleRun run(pair_json(options, m.at), tested_backend(), 1, [&](particles::Spheres& s) {
    s.position = {{m.at, 0, 0}, {m.at + 2 * R + gap, 0, 0}};
    s.velocity = {{m.speed / 2, 0, 0}, {-m.speed / 2, 0, 0}};
  });
  const auto wait = static_cast<std::uint32_t>(gap / (m.speed * m.dt()));
  run.advance(Collision::steps + 2 * wait, m.dt());
  const particles::Spheres s = run.state();
  return std::abs((s.velocity[1].x - s.velocity[0].x) / m.speed - restitution);
}

// The same collision with all numbers of type Real: leapfrog and the law of dem_server/laws/hertz.hpp.
template <class Real>
double error_of_emulation(const Collision& m) {
  const double l = std::log(restitution);
  const double alpha = -std::sqrt(5.0) * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
  const auto k = static_cast<Real>(stiffness), c = static_cast<Real>(alpha * std::sqrt(mass / 2 * stiffness)),
             dt = static_cast<Real>(m.dt()), inverse_mass = static_cast<Real>(1 / mass);
  Real x[2] = {static_cast<Real>(m.at), static_cast<Real>(m.at + 2 * R + gap)};
  Real v[2] = {static_cast<Real>(m.speed / 2), static_cast<Real>(-m.speed / 2)};
  const int wait = static_cast<int>(gap / (m.speed * m.dt()));
  for (int i = 0; i < Collision::steps + 2 * wait; ++i) {
    const Real overlap = static_cast<Real>(2 * R) - (x[1] - x[0]), u = v[1] - v[0];
    const Real F = overlap > 0 ? k * std::pow(overlap, Real(1.5)) - c * std::pow(overlap, Real(0.25)) * u : 0;
    v[0] -= F * inverse_mass * dt;
    v[1] += F * inverse_mass * dt;
    for (int j = 0; j < 2; ++j) x[j] += v[j] * dt;
  }
  return std::abs(static_cast<double>(v[1] - v[0]) / m.speed - restitution);
}

TEST(Precision, ImpactFarFromTheOrigin) {
  std::printf(
      "  error of the restitution 0.8\n  | distance | speed | deepest | mixed | double | all in float | all "
      "in double |\n");
  for (const double speed : {1.0, 0.01})
    for (const double at : {0.0, 1.0, 100.0, 1e4}) {
      const Collision m{at, speed};
      const double mixed = error_of_solver(m, ""), full = error_of_solver(m, R"("precision": "double",)"),
                   single = error_of_emulation<float>(m), check = error_of_emulation<double>(m);
      std::printf("  | %g m | %g m/s | %.1e m | %.1e | %.1e | %.1e | %.1e |\n", at, speed, m.deepest(), mixed,
                  full, single, check);
      EXPECT_LT(mixed, 1e-3);
      EXPECT_LT(full, 1e-3);
      EXPECT_LT(check, 1e-3) << "the emulation is right but for its precision";
      if (at >= 1) {
        EXPECT_GT(single, 0.02);
      }
    }
}

// A sphere creeps freely for 1e5 steps.
TEST(Precision, Creep) {
  std::printf(
      "  error of the way after 100,000 steps of 10 us, relative\n  | distance | speed | mixed | double | "
      "all in float |\n");
  constexpr double dt = 1e-5;
  constexpr std::uint32_t steps = 100000;
  for (const double at : {0.1, 1.0, 1000.0})
    for (const double speed : {1e-4, 1e-6}) {
      const auto error = [&](const char* options) {
        ParticleRun run(pair_json(options, at), tested_backend(), 1, [&](particles::Spheres& s) {
          s.position = {{at, 0, 0}, {at + 0.1, 0, 0}};
          s.velocity = {{speed, 0, 0}, {}};
        });
        for (std::uint32_t done = 0; done < steps; done += 1000) run.advance(1000, dt);
        return std::abs((run.state().position[0].x - at) / (speed * steps * dt) - 1);
      };
      float x = static_cast<float>(at);
      for (std::uint32_t i = 0; i < steps; ++i) x += static_cast<float>(speed * dt);
      const double mixed = error(""), full = error(R"("precision": "double",)"),
                   single =
                       std::abs(static_cast<double>(x - static_cast<float>(at)) / (speed * steps * dt) - 1);
      std::printf("  | %g m | %g m/s | %.1e | %.1e | %.1e |\n", at, speed, mixed, full, single);
      // Largest possible rounding of the additions in double precision.
      const double rounding = 0.5 * std::numeric_limits<double>::epsilon() * 2 * at / (speed * dt);
      EXPECT_LT(mixed, rounding + 1e-12);
      EXPECT_LT(full, rounding + 1e-12);
      EXPECT_GT(single, 0.01);
    }
}

}  // namespace precision_test
}  // namespace tandem::test
