// A liquid at rest in a cylinder of triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/equations/hydrostatic.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"

namespace tandem::test {
namespace {

using namespace sph;

constexpr double g = 9.81;

// A cylinder of triangles, filled by packing.
TEST(StillColumn, RestsInACylinder) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = 0.1;
  l.gravity = {0, 0, -g};
  const double radius = 0.35, depth = 0.6, end = 3;
  l.sound_speed = suggested_sound_speed(0, g, depth);
  l.artificial = 0.1;
  const Pose centre{{0, 0, depth}, {}};
  setup.walls = {transformed(cylinder_mesh(radius, 2 * depth, 20, {"+z"}), centre)};
  setup.domain = {{-0.5, -0.5, -0.1}, {0.5, 0.5, 2 * depth}};
  const TriangleMesh region = transformed(cylinder_mesh(radius, 2 * depth, 20), centre);
  const auto engine = make_liquid_engine(setup, true);
  const LiquidState start = fill_region(setup, engine->poses(), region, {depth, {}});
  engine->set_state(start);
  const double weight = static_cast<double>(start.size()) * l.mass() * g, potential = weight * depth / 2;
  const double dt = step_limits(l, 0.1 * l.sound_speed, 0).smallest;
  const int steps = static_cast<int>(end / dt);
  double load = 0, late = 0;
  int counted = 0;
  std::printf("still column in a cylinder, 6 spacings high, 7 wide, %zu particles, %.0f s\n", start.size(),
              end);
  expect_figure(
      "mass / (volume below the level and density)", 1,
      static_cast<double>(start.size()) * l.mass() / (l.density * volume_below(region, {0, 0, 1}, depth)),
      0.01);
  for (int k = 0; k < steps; ++k) {
    engine->step(dt);
    const double kinetic = engine->energies().kinetic / potential;
    if (k % (steps / 5) == 0) std::printf("  %5.2f s: kinetic / potential energy %.2e\n", k * dt, kinetic);
    if (k < steps * 3 / 4) continue;
    load -= engine->loads()[0].force.z;
    late = std::max(late, kinetic);
    ++counted;
  }
  expect_figure("load / weight, mean of the last 1 s", 1, load / counted / weight, 1e-3);
  expect_figure("largest kinetic / potential energy in it", 0, late, 1e-5);
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
  expect_figure("pressure error / bottom pressure, mean square", 0, std::sqrt(squares / inside), 0.02);
}

}  // namespace
}  // namespace tandem::test
