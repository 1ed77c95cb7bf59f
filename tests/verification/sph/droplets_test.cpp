// What becomes of the energy of a flow whose surface bursts into droplets, and what the limits of speed and
// density say about it: a column that collapses against a wall, with the speed of sound by rule.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/equations/limits.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/spacings.hpp"

namespace tandem::test {
namespace droplets_test {

using namespace sph;

constexpr double g = 9.81, H = 0.3, column = 2 * H, tank = 1.61, tank_height = 0.9;  // [m]
constexpr double end = 5, sample = 0.05;  // times are t sqrt(g/H); the front hits the wall at 2.4
// A thin stream on a floor without friction has v^2/2g = 2 H at its tip [Ritter1892].
constexpr double head = 2 * H;  // [m]

struct Figures {
  double moved = 0;  // largest kinetic energy [J]
  EnergyBalance works;
  double unexplained = 0;  // [J]
  double highest = 0;      // largest share of the mass with 1.2 times the head
  double top = 0;          // largest head of a particle [m]
  double fast_share = 0, dense_share = 0, mach = 0, density = 0;
  double push = 0, weight = 0;  // mean load on the tank from 2.5 to 5, along x and downwards [N]
};

// A slice, periodic along y, with `high` spacings over the height of the column.
Figures run(int high, double sound) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = H / high;
  l.gravity = {0, 0, -g};
  l.viscosity = 0.001;
  l.artificial = 0.02;
  l.sound_speed = sound * suggested_sound_speed(0, g, H);
  setup.slip = {true, true};
  const double breadth = 7 * l.spacing;
  setup.walls = {transformed(box_mesh({tank, 3 * breadth, tank_height}, {"+y", "-y", "+z"}),
                             Pose{{tank / 2, breadth / 2, tank_height / 2}, {}})};
  // Larger than the tank: nothing leaves it.
  setup.domain = {{-tank, 0, -tank}, {2 * tank, breadth, 3 * tank_height}};
  setup.periods.min = setup.domain.min;
  setup.periods.length = {0, breadth, 0};
  const TriangleMesh region =
      transformed(box_mesh({column, breadth, H}), Pose{{column / 2, breadth / 2, H / 2}, {}});
  // At the start a gate still holds the column.
  LiquidSetup gated = setup;
  TriangleMesh gate;
  gate.vertices = {{column, -breadth, -H},
                   {column, 2 * breadth, -H},
                   {column, 2 * breadth, 2 * H},
                   {column, -breadth, 2 * H}};
  gate.triangles = {{0, 1, 2}, {0, 2, 3}};
  gated.walls.push_back(gate);
  const std::vector<particles::BodyPose> poses(2, particles::BodyPose{{}, Mat3d::identity(), {}, {}});
  const auto engine = make_engine(setup, true);
  engine->set_state(fill(gated, poses, region, {H, {}}));
  const EnergyBalance begin = engine->energies();
  const double unit = std::sqrt(H / g);
  Figures f;
  double t = 0, pushed = 0;
  for (int k = 1; sample * k <= end + 1e-9; ++k) {
    while (t < sample * k * unit - 1e-12) {
      const StepFigures now = engine->figures();
      const double limit = step_limits(l, now.largest_speed, now.largest_acceleration).smallest,
                   left = sample * k * unit - t, step = left / std::ceil(left / limit);
      engine->step(step);
      t += step;
      const StepFigures after = engine->figures();
      f.fast_share = std::max(f.fast_share, after.fast_share);
      f.dense_share = std::max(f.dense_share, after.dense_share);
      f.mach = std::max(f.mach, after.largest_speed / l.sound_speed);
      f.density = std::max(f.density, after.largest_compression);
      if (t < 2.5 * unit) continue;
      pushed += step;
      f.push += step * engine->step_loads()[0].force.x;
      f.weight -= step * engine->step_loads()[0].force.z;
    }
    const LiquidState s = engine->state();
    double beyond = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double here = norm2(s.velocity[i]) / (2 * g) + s.position[i].z;
      beyond += here > 1.2 * head ? 1 : 0;
      f.top = std::max(f.top, here);
    }
    f.highest = std::max(f.highest, beyond / static_cast<double>(s.size()));
    f.works = engine->energies();
    f.moved = std::max(f.moved, f.works.kinetic);
  }
  f.push /= pushed * breadth;
  f.weight /= pushed * breadth;
  f.unexplained =
      f.works.kinetic + f.works.compression - begin.kinetic - begin.compression - f.works.changes();
  EXPECT_EQ(engine->figures().passed_walls, 0u);
  std::printf(
      "%d spacings over the height, %zu particles, %.3g times the speed of sound by rule: Mach number %.3f, "
      "density error %.3f, share beyond 0.2 %.4f, share off by 0.03 %.4f\n",
      high, engine->state().size(), sound, f.mach, f.density, f.fast_share, f.dense_share);
  std::printf(
      "  works / largest kinetic energy: gravity %.4f, ghosts %.4f, repulsion %.5f, diffusion %.4f, "
      "viscosity "
      "%.4f, bulk viscosity %.4f, cavitation %.4f, unexplained %.5f\n",
      f.works.gravity / f.moved, f.works.ghost / f.moved, f.works.repulsion / f.moved,
      f.works.diffusion / f.moved, f.works.viscosity / f.moved, f.works.bulk_viscosity / f.moved,
      f.works.cavitation / f.moved, f.unexplained / f.moved);
  std::printf(
      "  largest head v^2/2g + z %.3f m, share of the mass with 1.2 times that of the tip %.5f; mean load "
      "per "
      "breadth %.4g N/m along the tank, %.4g downwards\n",
      f.top, f.highest, f.push, f.weight);
  return f;
}

class Droplets : public testing::TestWithParam<int> {};

TEST_P(Droplets, OfACollapsedColumnAreNoAlarm) {
  const Figures by_rule = run(GetParam(), 1), fast = run(GetParam(), 2), slow = run(GetParam(), 0.5);
  expect_figure("work of repulsion / energy that moves", 0, by_rule.works.repulsion / by_rule.moved, 0.02);
  expect_figure("unexplained energy / energy that moves", 0, by_rule.unexplained / by_rule.moved, 0.02);
  expect_figure("load along the tank / that with twice the speed of sound", 1, by_rule.push / fast.push,
                0.06);
  expect_figure("load downwards / that with twice the speed of sound", 1, by_rule.weight / fast.weight, 0.03);
  EXPECT_LT(by_rule.fast_share, largest_fast_share);
  EXPECT_LT(by_rule.dense_share, largest_dense_share);
  EXPECT_GT(slow.fast_share, largest_fast_share) << "half the speed of sound must be suspect";
}

INSTANTIATE_TEST_SUITE_P(Spacings, Droplets, testing::ValuesIn(spacings({8})));

}  // namespace droplets_test
}  // namespace tandem::test
