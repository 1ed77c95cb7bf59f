// Liquids between walls that turn: curved walls are triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/probe.hpp"
#include "sph_server/equations/hydrostatic.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/spacings.hpp"

namespace tandem::test {
namespace rotation_test {

using namespace sph;

constexpr double g = 9.81, pi = std::numbers::pi;

particles::BodyPose turned(double angle, double rate) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{}, Mat3d{{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}}, {}, {0, 0, rate}};
}

class Bucket : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Spacings, Bucket, testing::ValuesIn(spacings({6})));

// A bucket turns about its axis, with a liquid that turns with it. In the steady state the surface is
// z = z0 + w^2 r^2 / 2g, and the pressure rho g (surface - z).
TEST_P(Bucket, ThatTurnsHasAParabolicSurface) {
  constexpr double radius = 0.3, depth = 0.3, end = 1.6;
  constexpr int segments = 24;
  const double spacing = radius / GetParam(), rise = 2. / 3 * radius, w = std::sqrt(2 * g * rise) / radius;
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = spacing;
  l.gravity = {0, 0, -g};
  l.sound_speed = suggested_sound_speed(w * radius, g, depth);
  l.viscosity = 20;  // so that it comes to rest soon
  const double height = 4 * depth;
  setup.walls = {transformed(cylinder_mesh(radius, height, segments, {"+z"}), Pose{{0, 0, height / 2}, {}})};
  setup.domain = {{-radius - spacing, -radius - spacing, -spacing},
                  {radius + spacing, radius + spacing, height}};
  const TriangleMesh region =
      transformed(cylinder_mesh(radius, height, segments), Pose{{0, 0, height / 2}, {}});
  LiquidState start = fill(setup, {turned(0, 0)}, region, {depth, {}});
  for (std::size_t i = 0; i < start.size(); ++i) start.velocity[i] = cross({0, 0, w}, start.position[i]);
  const auto engine = make_engine(setup, true);
  engine->set_state(start, {turned(0, w)});
  for (double t = 0; t < end * (1 - 1e-9);) {
    const StepFigures figures = engine->figures();
    const double limit = step_limits(l, figures.largest_speed, figures.largest_acceleration).smallest,
                 step = (end - t) / std::ceil((end - t) / limit);
    t += step;
    engine->step(step, {turned(w * t, w)});
  }
  const LiquidState s = engine->state();
  // Surface at each particle below it, from its pressure, against the parabola of the same volume.
  const double area = setup.walls[0].vertices.empty() ? 0 : volume_below(region, {0, 0, 1}, depth) / depth;
  const double mean_square_radius = radius * radius / 2 * (area / (pi * radius * radius));
  const double z0 = depth - w * w * mean_square_radius / (2 * g);
  double squares = 0, worst = 0, kinetic = 0;
  int counted = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Vec3d x = s.position[i];
    const double r2 = x.x * x.x + x.y * x.y, surface = x.z + s.pressure[i] / (l.density * g),
                 off = (surface - z0 - w * w * r2 / (2 * g)) / spacing;
    squares += off * off;
    worst = std::max(worst, std::fabs(off));
    kinetic += norm2(s.velocity[i] - cross({0, 0, w}, x)) / (w * w * radius * radius);
    ++counted;
  }
  Walls walls(setup.walls, l.support());
  walls.set_pose(0, turned(w * end, w));
  const Probe probe(s, l, setup.periods, walls);
  double level = 0;  // the largest deviation of a level, up to the first layer at the wall [spacings]
  for (double r = 0; r < radius - 0.5 * spacing; r += 0.5 * spacing)
    for (int k = 0; k < 6; ++k) {
      const Vec3d from{r * std::cos(pi / 3 * k), r * std::sin(pi / 3 * k), 0};
      const double off = (probe.level_on(from, {0, 0, 1}) - z0 - w * w * r * r / (2 * g)) / spacing;
      level = std::max(level, std::fabs(off));
    }
  std::printf("bucket of a radius of %d spacings, %zu particles, the rim rises by %.3g spacings\n",
              GetParam(), s.size(), rise / spacing);
  expect_figure("levels, worst [spacings]", 0, level, 1);
  expect_figure("surface by pressure, mean square [spacings]", 0, std::sqrt(squares / counted), 0.5);
  std::printf("  surface by pressure, worst [spacings]: %.3f\n", worst);
  expect_figure("velocity relative to the bucket / rim", 0, std::sqrt(kinetic / counted), 0.02);
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
}

// Between a cylinder that turns and one at rest, the torque per length is
// 4 pi mu w R1^2 R2^2 / (R2^2 - R1^2).
struct Annulus {
  LiquidSetup setup;
  LiquidState start;
  double inner = 0.5, outer = 1, length = 0;  // [m]
  explicit Annulus(int across) {
    Liquid& l = setup.liquid;
    l.density = 1;
    l.viscosity = 0.2;
    l.spacing = (outer - inner) / across;
    l.sound_speed = suggested_sound_speed(inner, 0, 0);
    length = 10 * l.spacing;
    constexpr int segments = 60;
    for (const double radius : {inner, outer}) {
      // The facets have the mean distance `radius` from the axis.
      const double mean = radius * (1 + pi * pi / (6.0 * segments * segments));
      setup.walls.push_back(
          transformed(cylinder_mesh(mean, 3 * length, segments, {"+z", "-z"}), Pose{{0, 0, length / 2}, {}}));
    }
    setup.domain = {{-outer - l.spacing, -outer - l.spacing, 0},
                    {outer + l.spacing, outer + l.spacing, length}};
    setup.periods.min = setup.domain.min;
    setup.periods.length = {0, 0, length};
    // Rings of particles of the volume of a cube each.
    for (int k = 0; k < 10; ++k)
      for (int ring = 0; ring < across; ++ring) {
        const double r = inner + (ring + 0.5) * l.spacing;
        const int around = static_cast<int>(std::lround(2 * pi * r / l.spacing));
        for (int n = 0; n < around; ++n) {
          const double angle = 2 * pi * (n + 0.5 * (k % 2) + 0.37 * ring) / around;
          start.position.push_back({r * std::cos(angle), r * std::sin(angle), (k + 0.5) * l.spacing});
          const double v = (outer * outer / r - r) * inner * inner / (outer * outer - inner * inner);
          start.velocity.push_back({-v * std::sin(angle), v * std::cos(angle), 0});
          start.compression.push_back(0);
        }
      }
  }
};

// Torques on both cylinders / expected, mean of the last third.
std::pair<double, double> torques(int across, double end) {
  Annulus a(across);
  const double w = 1;
  const auto engine = make_engine(a.setup, true);
  engine->set_state(a.start, {turned(0, w), turned(0, 0)});
  const double limit = step_limits(a.setup.liquid, 1.2 * a.inner, 0).smallest;
  const int steps = static_cast<int>(std::ceil(end / limit));
  double on_inner = 0, on_outer = 0;
  int counted = 0;
  for (int k = 1; k <= steps; ++k) {
    engine->step(end / steps, {turned(w * k * end / steps, w), turned(0, 0)});
    if (k < steps * 2 / 3) continue;
    const auto loads = engine->loads();
    on_inner -= loads[0].torque.z;
    on_outer += loads[1].torque.z;
    ++counted;
  }
  const double i2 = a.inner * a.inner, o2 = a.outer * a.outer;
  const double expected = 4 * pi * a.setup.liquid.viscosity * w * i2 * o2 / (o2 - i2) * a.length * counted;
  return {on_inner / expected, on_outer / expected};
}

TEST(TaylorCouette, TorqueIsThatOfTheClosedForm) {
  const auto coarse = torques(6, 0.3), fine = torques(12, 0.3);
  std::printf("cylinders of 0.5 and 1 m, with 6 and 12 spacings between them\n");
  std::printf("  torque / expected: inner %.4f and %.4f, outer %.4f and %.4f\n", coarse.first, fine.first,
              coarse.second, fine.second);
  expect_figure("torque on the inner cylinder / expected", 1, fine.first, 0.02);
  expect_figure("torque on the outer cylinder / expected", 1, fine.second, 0.02);
}

}  // namespace rotation_test
}  // namespace tandem::test
