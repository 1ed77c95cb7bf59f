// A liquid at rest in a cylinder of triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/probe.hpp"
#include "sph_server/equations/hydrostatic.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/spacings.hpp"

namespace tandem::test {
namespace still_cylinder_test {

using namespace sph;

constexpr double g = 9.81;

// A cylinder of `segments` facets, twice as high as the liquid or closed and 1.25 times as high, filled by
// packing; it rests for `end` [s], of which the second half counts.
void rest_in_cylinder(double radius, double depth, int segments, double end, double kinetic_tolerance,
                      bool closed = false) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = 0.1;
  l.gravity = {0, 0, -g};
  l.sound_speed = suggested_sound_speed(0, g, depth);
  l.artificial = 0.1;
  const double height = (closed ? 1.25 : 2) * depth;
  const Pose centre{{0, 0, 0.5 * height}, {}};
  const std::vector<std::string> open_ends =
      closed ? std::vector<std::string>{} : std::vector<std::string>{"+z"};
  setup.walls = {transformed(cylinder_mesh(radius, height, segments, open_ends), centre)};
  setup.domain = {{-0.5, -0.5, -0.1}, {0.5, 0.5, 2 * depth}};
  const TriangleMesh region = transformed(cylinder_mesh(radius, height, segments), centre);
  const auto engine = make_engine(setup, true);
  const LiquidState start = fill(setup, engine->poses(), region, {depth, {}});
  engine->set_state(start);
  const double weight = static_cast<double>(start.size()) * l.mass() * g, potential = weight * depth / 2;
  const double dt = step_limits(l, 0.1 * l.sound_speed, 0).smallest;
  const int steps = static_cast<int>(end / dt);
  double load = 0, late = 0, at_bottom = 0;
  int counted = 0, read = 0;
  const Walls walls(setup.walls, l.support());
  constexpr int readings = 200;
  std::printf("still column in a cylinder, %.0f spacings high, %.0f wide, %zu particles, %.0f s\n",
              depth / l.spacing, 2 * radius / l.spacing, start.size(), end);
  expect_figure(
      "mass / (volume below the level and density)", 1,
      static_cast<double>(start.size()) * l.mass() / (l.density * volume_below(region, {0, 0, 1}, depth)),
      0.01);
  for (int k = 0; k < steps; ++k) {
    engine->step(dt);
    const double kinetic = engine->energies().kinetic / potential;
    if (k % (steps / 5) == 0) std::printf("  %5.2f s: kinetic / potential energy %.2e\n", k * dt, kinetic);
    if (k < steps / 2) continue;
    load -= engine->loads()[0].force.z;
    late = std::max(late, kinetic);
    ++counted;
    if (k % std::max(1, steps / 2 / readings) != 0) continue;
    at_bottom += Probe(engine->state(), l, setup.periods, walls).pressure_at({0, 0, 0});
    ++read;
  }
  const double area = volume_below(region, {0, 0, 1}, depth) / depth;
  expect_figure("pressure at the bottom / weight on it, mean", 1, at_bottom / read / (weight / area), 0.005);
  expect_figure("load / weight, mean of the second half", 1, load / counted / weight, 1e-3);
  expect_figure("largest kinetic / potential energy in it", 0, late, kinetic_tolerance);
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

// A tank that is closed, as an engineer gives it: seen from its wall dozens of facets hide the lid of the
// packing.
TEST(StillColumn, RestsInACylinder) {
  if (tested_backend() == particles::Backend::cuda) {
    for (const int high : spacings({40})) rest_in_cylinder(0.35, 0.1 * high, 20, 20, 1e-6);
  } else if (SOAK) {
    rest_in_cylinder(0.35, 0.6, 20, 3, 1e-4);
    rest_in_cylinder(0.5, 0.8, 52, 2, 1e-4, true);
  } else {
    rest_in_cylinder(0.25, 0.4, 24, 1, 1e-4, true);
  }
}

}  // namespace still_cylinder_test
}  // namespace tandem::test
