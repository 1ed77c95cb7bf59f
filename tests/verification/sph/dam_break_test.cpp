// A column of water that collapses beside a wall, against its own fine run and the experiment of
// [KoshizukaOka1996], whose data are beside the project.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/measured.hpp"

namespace tandem::test {
namespace dam_break_test {

using namespace sph;

constexpr double g = 9.81, wide = 0.146, end = 2.7;  // [m]; times are t sqrt(2g/L)

// Front / L at the times 0, 0.1, ... The column is `wide` and twice as high, with `across` spacings along its
// width; a slice, periodic along y.
std::vector<double> front(int across) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = wide / across;
  l.gravity = {0, 0, -g};
  l.sound_speed = suggested_sound_speed(0, g, 2 * wide);
  l.artificial = 0.02;
  setup.slip = {true};
  const double breadth = 10 * l.spacing, length = 5 * wide, top = 3 * wide;
  setup.walls = {transformed(box_mesh({length, 3 * breadth, top}, {"+y", "-y", "+z"}),
                             Pose{{length / 2, breadth / 2, top / 2}, {}})};
  setup.domain = {{-l.spacing, 0, -l.spacing}, {length + l.spacing, breadth, top}};
  setup.periods.min = setup.domain.min;
  setup.periods.length = {0, breadth, 0};
  const TriangleMesh region =
      transformed(box_mesh({wide, breadth, 2 * wide}), Pose{{wide / 2, breadth / 2, wide}, {}});
  const auto engine = make_engine(setup, true);
  // At the start a gate still holds the column.
  LiquidSetup gated = setup;
  TriangleMesh gate;
  gate.vertices = {
      {wide, -breadth, -wide}, {wide, 2 * breadth, -wide}, {wide, 2 * breadth, top}, {wide, -breadth, top}};
  gate.triangles = {{0, 1, 2}, {0, 2, 3}};
  gated.walls.push_back(gate);
  const std::vector<particles::BodyPose> poses(2, particles::BodyPose{{}, Mat3d::identity(), {}, {}});
  engine->set_state(fill(gated, poses, region, {2 * wide, {}}));
  const EnergyBalance begin = engine->energies();
  const double unit = std::sqrt(wide / (2 * g)), dt = step_limits(l, 0.3 * l.sound_speed, 0).smallest;
  std::vector<double> found;
  double t = 0;
  for (int k = 0; 0.1 * k < end; ++k) {
    while (t < 0.1 * k * unit - 1e-9) {
      const double step = std::min(dt, 0.1 * k * unit - t);
      engine->step(step);
      t += step;
    }
    double most = 0;
    for (const Vec3d& x : engine->state().position) most = std::max(most, x.x);
    found.push_back((most + 0.5 * l.spacing) / wide);
  }
  EXPECT_EQ(engine->figures().passed_walls, 0u);
  const EnergyBalance e = engine->energies();
  std::printf(
      "  %d across: front %.3f, energy / work of gravity: kinetic %.4f, compression %.4f, viscosity %.4f, "
      "bulk %.4f, diffusion %.4f, ghosts %.4f\n",
      across, found.back(), e.kinetic / e.gravity, e.compression / e.gravity, e.viscosity / e.gravity,
      e.bulk_viscosity / e.gravity, e.diffusion / e.gravity, e.ghost / e.gravity);
  expect_figure("change of energy - works / work of gravity", 0,
                (e.kinetic + e.compression - begin.kinetic - begin.compression - e.changes()) / e.gravity,
                0.01);
  return found;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0;
  for (std::size_t k = 0; k < a.size(); ++k) squares += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(squares / static_cast<double>(a.size()));
}

TEST(DamBreak, ConvergesToItsOwnFineRun) {
  std::printf("column of water, twice as high as wide, until t sqrt(2g/L) = %.1f\n", end);
  const auto coarse = front(5), medium = front(7), fine = front(10);
  const double first = difference(coarse, fine), second = difference(medium, fine);
  std::printf("  distance of the front to that of the fine run / L: %.4f with 5 spacings, %.4f with 7\n",
              first, second);
  EXPECT_LT(second, first);
  expect_figure("front of 7 spacings - that of 10 / L", 0, second, 0.1);

  const auto measured = measured_rows("dambreak_koshizuka_oka1996/koshizuka_oka1996_exp.csv");
  if (measured.empty())
    GTEST_SKIP()
        << "no comparison with the experiment: the data of [KoshizukaOka1996] are not beside the project";
  double squares = 0;
  int counted = 0;
  for (const auto& row : measured) {
    const double time = row[0], position = row[1];
    if (time >= 0.1 * static_cast<double>(fine.size() - 1)) continue;
    const double at = time * 10;
    const auto before = static_cast<std::size_t>(at);
    const double here = fine[before] + (at - static_cast<double>(before)) * (fine[before + 1] - fine[before]);
    std::printf("  t sqrt(2g/L) %.3f: front / L %.3f, in the experiment %.3f\n", time, here, position);
    squares += (here - position) * (here - position);
    ++counted;
  }
  expect_figure("front - experiment / L, root of the mean square", 0, std::sqrt(squares / counted), 0.3);
}

}  // namespace dam_break_test
}  // namespace tandem::test
