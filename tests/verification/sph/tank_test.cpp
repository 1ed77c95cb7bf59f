// A liquid in a tank that is accelerated, and the waves in one at rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/equations/hydrostatic.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/spacings.hpp"

namespace tandem::test {
namespace tank_test {

using namespace sph;

constexpr double g = 9.81, pi = std::numbers::pi;

// A slice of an open tank, [0, length] along x, periodic along y, 10 spacings wide.
struct Slice {
  LiquidSetup setup;
  LiquidState start;
  double length = 0, depth = 0, width = 0;  // [m]
  Slice(double long_, double deep, double spacing, double travel) : length(long_), depth(deep) {
    Liquid& l = setup.liquid;
    l.spacing = spacing;
    l.gravity = {0, 0, -g};
    l.sound_speed = suggested_sound_speed(0, g, depth);
    width = 10 * spacing;
    const double top = 2.5 * depth;
    setup.walls = {transformed(box_mesh({length, 3 * width, top}, {"+y", "-y", "+z"}),
                               Pose{{length / 2, width / 2, top / 2}, {}})};
    setup.domain = {{-spacing, 0, -spacing}, {length + travel + spacing, width, top + depth}};
    setup.periods.min = setup.domain.min;
    setup.periods.length = {0, width, 0};
    const TriangleMesh region =
        transformed(box_mesh({length, width, depth}), Pose{{length / 2, width / 2, depth / 2}, {}});
    start = fill(setup, {{{}, Mat3d::identity(), {}, {}}}, region, {depth, {}});
  }
  double step() const {
    return step_limits(setup.liquid, 0.3 * setup.liquid.sound_speed, 0).smallest;
  }  // [s]
};

// Adds to the equations of least squares for p = c0 + c1 x + c2 z over the particles of at least the pressure
// `least`. origin: of x and z.
void add_moments(const LiquidState& s, Vec3d origin, double least, double (&moment)[3][4]) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Vec3d x = s.position[i] - origin;
    if (s.pressure[i] < least) continue;
    const double row[4] = {1, x.x, x.z, s.pressure[i]};
    for (int p = 0; p < 3; ++p)
      for (int q = 0; q < 4; ++q) moment[p][q] += row[p] * row[q];
  }
}

// The surface of a liquid in a tank with the acceleration a has the slope -a/g, and its pressure the gradient
// -rho (a, 0, g).
TEST(Tank, ThatIsAcceleratedHasAnInclinedSurface) {
  constexpr double a = 2, end = 2.4, ramp = 1.2;
  const auto position = [&](double t) {
    const double s = std::min(t, ramp), after = std::max(0.0, t - ramp);
    // The acceleration grows as (1 - cos(pi t / ramp)) / 2.
    const double w = pi / ramp, x = a / 2 * (s * s / 2 - (1 - std::cos(w * s)) / (w * w)),
                 v = a / 2 * (s - std::sin(w * s) / w);
    return std::pair{x + v * after + a * after * after / 2, v + a * after};
  };
  Slice tank(0.6, 0.3, 0.05, position(end).first);
  Liquid& l = tank.setup.liquid;
  l.artificial = 0.3;
  const auto engine = make_engine(tank.setup, true);
  engine->set_state(tank.start);
  auto poses = engine->poses();
  const int steps = static_cast<int>(std::ceil(end / tank.step()));
  const double dt = end / steps;
  double load = 0, moment[3][4]{};
  int counted = 0;
  for (int k = 1; k <= steps; ++k) {
    std::tie(poses[0].p.x, poses[0].v.x) = position(k * dt);
    engine->step(dt, poses);
    if (k < steps * 2 / 3) continue;
    load -= engine->loads()[0].force.x;
    ++counted;
    if (k % 20 == 0) add_moments(engine->state(), poses[0].p, 0.3 * l.density * g * tank.depth, moment);
  }
  const double mass = static_cast<double>(tank.start.size()) * l.mass();
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q) {
      if (q == p) continue;
      const double factor = moment[q][p] / moment[p][p];
      for (int c = 0; c < 4; ++c) moment[q][c] -= factor * moment[p][c];
    }
  const double along = moment[1][3] / moment[1][1], up = moment[2][3] / moment[2][2];
  std::printf("tank with an acceleration of %.0f m/s2, %zu particles\n", a, tank.start.size());
  expect_figure("slope of the surfaces of equal pressure / (a/g)", 1, along / up / (a / g), 0.05);
  expect_figure("gradient of the pressure along gravity / rho g", 1, -up / (l.density * g), 0.02);
  expect_figure("load / (mass of the liquid and acceleration)", 1, load / counted / (mass * a), 0.02);
}

// The frequency of the first linear wave: w^2 = g k tanh(k h).
double frequency(int along) {
  const double length = 1, depth = 0.5, k = pi / length, w = std::sqrt(g * k * std::tanh(k * depth));
  Slice tank(length, depth, length / along, 0);
  tank.setup.slip = {true};
  const double amplitude = 0.01;
  for (std::size_t i = 0; i < tank.start.size(); ++i) {
    const Vec3d x = tank.start.position[i];
    const double u = amplitude * w / std::sinh(k * depth);
    tank.start.velocity[i] = {u * std::cosh(k * x.z) * std::sin(k * x.x), 0,
                              -u * std::sinh(k * x.z) * std::cos(k * x.x)};
  }
  const auto engine = make_engine(tank.setup, true);
  engine->set_state(tank.start);
  const double dt = tank.step();
  std::vector<double> zeros;
  double last = 1, t = 0;
  while (zeros.size() < 3) {
    engine->step(dt);
    t += dt;
    double now = 0;
    const LiquidState s = engine->state();
    for (std::size_t i = 0; i < s.size(); ++i) now += s.velocity[i].x * std::sin(k * s.position[i].x);
    if ((now > 0) != (last > 0)) zeros.push_back(t - dt * now / (now - last));
    last = now;
    if (t > 10) break;
  }
  return pi / ((zeros.back() - zeros.front()) / static_cast<double>(zeros.size() - 1)) / w;
}

TEST(Tank, HasWavesOfTheFrequencyOfLinearTheory) {
  std::printf("first linear wave in a tank twice as long as deep\n");
  for (const int along : spacings({16})) {
    std::printf("  %d along\n", along);
    expect_figure("frequency / sqrt(g k tanh(k h))", 1, frequency(along), 0.015);
  }
}

}  // namespace tank_test
}  // namespace tandem::test
