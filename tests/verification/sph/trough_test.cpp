// A liquid at rest in a corner of 30 degrees. A lattice does not fit there: the particles are packed first.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/equations/hydrostatic.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"

namespace tandem::test {
namespace trough_test {

using namespace sph;

constexpr double g = 9.81, depth = 1, half_angle = std::numbers::pi / 12;

// Two planes that meet at 30 degrees in the line x = z = 0, and two ends; filled up to z = depth.
struct Trough {
  static constexpr int high = 10, deep = 6;  // [spacings]
  LiquidSetup setup;
  LiquidState start;
  Trough() {
    Liquid& l = setup.liquid;
    l.spacing = depth / high;
    l.gravity = {0, 0, -g};
    l.sound_speed = suggested_sound_speed(0, g, depth);
    l.artificial = 0.1;
    const double length = deep * l.spacing, top = 1.6 * depth, side = top * std::tan(half_angle);
    TriangleMesh walls;
    walls.vertices = {{0, 0, 0},      {-side, 0, top},      {side, 0, top},
                      {0, length, 0}, {-side, length, top}, {side, length, top}};
    walls.triangles = {{0, 3, 4}, {0, 4, 1}, {0, 2, 5}, {0, 5, 3}, {0, 1, 2}, {3, 5, 4}};
    setup.walls = {walls};
    setup.domain = {{-side, -l.spacing, -l.spacing}, {side, length + l.spacing, top}};
    TriangleMesh region = walls;
    region.triangles.push_back({1, 4, 5});
    region.triangles.push_back({1, 5, 2});
    start = fill(setup, {{{}, Mat3d::identity(), {}, {}}}, region, {depth, {}});
  }
  double step() const { return step_limits(setup.liquid, 0.1 * setup.liquid.sound_speed, 0).smallest; }
};

TEST(Trough, HoldsALiquidAtRest) {
  const Trough trough;
  const auto engine = make_engine(trough.setup, true);
  engine->set_state(trough.start);
  const Liquid& l = trough.setup.liquid;
  const double weight = static_cast<double>(trough.start.size()) * l.mass() * g,
               potential = weight * 2 * depth / 3;
  const double dt = trough.step(), end = 14;
  const int steps = static_cast<int>(end / dt);
  double load = 0, late = 0;
  int counted = 0;
  std::printf("trough of 30 degrees, %d spacings high, %zu particles, %.0f s\n", Trough::high,
              trough.start.size(), end);
  for (int k = 0; k < steps; ++k) {
    engine->step(dt);
    if (k % (steps / 5) == 0)
      std::printf("  %5.2f s: kinetic / potential energy %.2e\n", k * dt,
                  engine->energies().kinetic / potential);
    if (k < steps * 5 / 7) continue;
    load -= engine->loads()[0].force.z;
    late = std::max(late, engine->energies().kinetic / potential);
    ++counted;
  }
  expect_figure("load / weight, mean of the last 4 s", 1, load / counted / weight, 1e-4);
  expect_figure("largest kinetic / potential energy in them", 0, late, 1e-6);
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
  double squares = 0;
  int inside = 0;
  const LiquidState s = engine->state();
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s.position[i].z > depth - 2 * l.spacing) continue;
    const double off =
        (s.pressure[i] - at_rest(l, depth - s.position[i].z).pressure) / (l.density * g * depth);
    squares += off * off;
    ++inside;
  }
  expect_figure("pressure error / bottom pressure, mean square", 0, std::sqrt(squares / inside), 0.015);
}

}  // namespace trough_test
}  // namespace tandem::test
