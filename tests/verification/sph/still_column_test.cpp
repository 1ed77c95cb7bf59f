// A liquid at rest under gravity: pressure, load and kinetic energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sph_server/engine/probe.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/spacings.hpp"

namespace tandem::test {
namespace still_column_test {

using namespace sph;

constexpr double g = 9.81;

// A device has the time for a higher column.
bool on_device() {
  return tested_backend() == particles::Backend::cuda;
}

// Open box [0, width]^2 x [0, height]: the floor is body 0, the sides are body 1.
std::vector<TriangleMesh> box_walls(double width, double height) {
  const Pose centre{{width / 2, width / 2, height / 2}, {}};
  const Vec3d size{width, width, height};
  return {transformed(box_mesh(size, {"+x", "-x", "+y", "-y", "+z"}), centre),
          transformed(box_mesh(size, {"+z", "-z"}), centre)};
}

// Depth of a column compressed by its own weight whose mass per area is rho0 * depth [m].
double compressed(double depth, double c) {
  return c * c / g * std::log(1 + g * depth / (c * c));
}

// Everything moves along x with `drift` [m/s].
void weigh(int high, double drift, double end) {
  constexpr int across = 6;
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  const double depth = 1.2;
  l.spacing = depth / high;
  l.gravity = {0, 0, -g};
  l.sound_speed = suggested_sound_speed(0, g, depth);
  l.artificial = 0.1;
  const double width = across * l.spacing;
  setup.walls = box_walls(width, 2 * depth);
  setup.domain = {{-l.spacing, -l.spacing, -l.spacing},
                  {width + drift * end + l.spacing, width + l.spacing, 2 * depth}};
  LiquidState start;
  for (int k = 0; k < high; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i) {
        const double above = (high - k - 0.5) * l.spacing;
        start.position.push_back({(i + 0.5) * l.spacing, (j + 0.5) * l.spacing,
                                  compressed(depth, l.sound_speed) - compressed(above, l.sound_speed)});
        start.velocity.push_back({drift, 0, 0});
        start.compression.push_back(std::pow(1 + 7 * g * above / (l.sound_speed * l.sound_speed), 1.0 / 7) -
                                    1);
      }
  const auto engine = make_engine(setup, true);
  auto poses = engine->poses();
  for (auto& pose : poses) pose.v = {drift, 0, 0};
  engine->set_state(start, poses);
  const double weight = static_cast<double>(start.size()) * l.mass() * g, potential = weight * depth / 2;
  const double dt = step_limits(l, 0.1 * l.sound_speed, 0).smallest;
  const int steps = static_cast<int>(end / dt);
  double load = 0, side = 0, late = 0, at_bottom = 0;
  int counted = 0, read = 0;
  Walls walls(setup.walls, l.support());
  constexpr int readings = 200;
  std::printf("still column, %d spacings high, %d wide, %.0f s, moving at %g m/s\n", high, across, end,
              drift);
  // Of the motion relative to the box.
  const auto kinetic = [&] {
    double sum = 0;
    for (const Vec3d& v : engine->state().velocity) sum += 0.5 * l.mass() * norm2(v - Vec3d{drift, 0, 0});
    return sum / potential;
  };
  for (int k = 0; k < steps; ++k) {
    for (auto& pose : poses) pose.p.x = drift * (k + 1) * dt;
    engine->step(dt, poses);
    if (k % (steps / 5) == 0) std::printf("  %5.2f s: kinetic / potential energy %.2e\n", k * dt, kinetic());
    if (k < steps / 2) continue;
    const auto loads = engine->loads();
    load += loads[0].force.z + loads[1].force.z;
    side += loads[1].force.z;
    late = std::max(late, kinetic());
    ++counted;
    if (k % std::max(1, steps / 2 / readings) != 0) continue;
    const LiquidState state = engine->state();
    for (std::uint32_t b = 0; b < walls.bodies(); ++b) walls.set_pose(b, poses[b]);
    at_bottom +=
        Probe(state, l, setup.periods, walls).pressure_at(poses[0].p + Vec3d{width / 2, width / 2, 0});
    ++read;
  }
  expect_figure("load / weight, mean of the second half", 1, -load / counted / weight, 1e-4);
  // What lacks is the ghost liquid behind two sides at once, in the four corners of the floor.
  expect_figure("load on the floor alone / weight", 1, -(load - side) / counted / weight, 0.01);
  expect_figure("largest kinetic / potential energy in it", 0, late, 1e-6);
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
  double nearest = 1, worst = 0, sum_z = 0, sum_p = 0, sum_zz = 0, sum_zp = 0, fitted = 0;
  double first_layer = 0, from_sides = 0;
  const LiquidState s = engine->state();
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Vec3d x = s.position[i] - Vec3d{drift * steps * dt, 0, 0};
    const double from_side = std::min({x.x, width - x.x, x.y, width - x.y}) / l.spacing;
    nearest = std::min({nearest, from_side, x.z / l.spacing});
    if (from_side < 1) {
      ++first_layer;
      from_sides += from_side;
    }
    const double still =
        l.density * l.sound_speed * l.sound_speed *
        std::expm1(g * (compressed(depth, l.sound_speed) - x.z) / (l.sound_speed * l.sound_speed));
    if (x.z > depth - 3 * l.spacing) continue;
    worst = std::max(worst, std::fabs(s.pressure[i] - still) / (l.density * g * depth));
    sum_z += x.z;
    sum_p += s.pressure[i];
    sum_zz += x.z * x.z;
    sum_zp += x.z * s.pressure[i];
    ++fitted;
  }
  const double slope = (fitted * sum_zp - sum_z * sum_p) / (fitted * sum_zz - sum_z * sum_z);
  // Of a sensor in the middle of the floor, against the weight on it.
  expect_figure("pressure at the bottom / weight, mean of it", 1,
                at_bottom / read / (weight / (width * width)), on_device() ? 0.002 : 0.005);
  expect_figure("linear pressure there / hydrostatic, at the end", 1,
                (sum_p - slope * sum_z) / fitted / (l.density * g * depth), 0.005);
  // No layer at the walls: the lattice may buckle, but has as many particles there as elsewhere.
  constexpr double outermost = across * across - (across - 2) * (across - 2);
  expect_figure("particles in the layer along the sides / all", outermost / (across * across),
                first_layer / static_cast<double>(s.size()), 0.01);
  expect_figure("their distance from the sides [spacings]", 0.5, from_sides / first_layer, 0.05);
  expect_figure("nearest particle to a wall [spacings]", 0.5, nearest, 0.15);
  expect_figure("worst pressure error / bottom pressure", 0, worst, 0.02);
}

TEST(StillColumn, WeighsOnItsFloor) {
  for (const int high : spacings({on_device() ? 40 : 12})) weigh(high, 0, on_device() ? 20 : 4);
}
TEST(StillColumn, WeighsAsMuchInABoxThatMoves) {
  for (const int high : spacings({on_device() ? 40 : 12})) weigh(high, 0.5, on_device() ? 20 : 1);
}

}  // namespace still_column_test
}  // namespace tandem::test
