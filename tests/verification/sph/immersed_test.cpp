// A cube is held in a still liquid. The liquid should push it up with the weight of what it displaces
// (Archimedes), at the start, when the particles are on a lattice, and later.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "sph_server/equations/hydrostatic.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/spacings.hpp"

namespace tandem::test {
namespace immersed_test {

using namespace sph;

void append_quad(TriangleMesh& m, Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
  const auto first = static_cast<std::uint32_t>(m.vertices.size());
  m.vertices.insert(m.vertices.end(), {a, b, c, d});
  m.triangles.push_back({first, first + 1, first + 2});
  m.triangles.push_back({first, first + 2, first + 3});
}

// The faces of a box, the upper one only where it is closed.
TriangleMesh box(Vec3d min, Vec3d max, bool closed) {
  const auto at = [&](int k) {
    return Vec3d{k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z};
  };
  TriangleMesh m;
  append_quad(m, at(0), at(1), at(3), at(2));
  append_quad(m, at(0), at(1), at(5), at(4));
  append_quad(m, at(2), at(3), at(7), at(6));
  append_quad(m, at(0), at(2), at(6), at(4));
  append_quad(m, at(1), at(3), at(7), at(5));
  if (closed) append_quad(m, at(4), at(5), at(7), at(6));
  return m;
}

class Immersed : public testing::TestWithParam<int> {};

TEST_P(Immersed, CubeGetsItsBuoyancy) {
  const int across = GetParam(), around = 3, n = across + 2 * around;
  constexpr double a = 0.01, g = 9.81, end = 0.12, from = 0.03;  // [m], [m/s2], [s], [s]
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = a;
  l.gravity = {0, 0, -g};
  l.sound_speed = 10 * std::sqrt(g * n * a);
  l.artificial = 0.1;
  // A line between two particles along an edge of the cube is hidden by it.
  const double low = around * a - 1e-9 * a, high = (around + across) * a + 1e-9 * a;
  setup.walls = {box({0, 0, 0}, {n * a, n * a, 2 * n * a}, false),
                 box({low, low, low}, {high, high, high}, true)};
  setup.slip = {true, true};
  setup.domain = {{-1, -1, -1}, {2, 2, 2}};
  LiquidState start;
  for (int k = 0; k < n * n * n; ++k) {
    const int at[3] = {k % n, k / n % n, k / n / n};
    bool in_cube = true;
    for (const int place : at) in_cube = in_cube && place >= around && place < around + across;
    if (in_cube) continue;
    start.position.push_back(a * Vec3d{at[0] + 0.5, at[1] + 0.5, at[2] + 0.5});
    start.velocity.push_back({});
    start.compression.push_back(at_rest(l, (n - at[2] - 0.5) * a).compression);
  }
  const auto engine = make_engine(setup, true);
  engine->set_state(start);
  const double buoyancy = l.density * g * std::pow(across * a, 3), at_once = engine->loads()[1].force.z,
               fastest = engine->figures().largest_acceleration;
  double impulse = 0, during = 0;
  for (double t = 0; t < end;) {
    const StepFigures f = engine->figures();
    const double dt = 0.95 * step_limits(l, f.largest_speed, f.largest_acceleration).smallest;
    t += dt;
    engine->step(dt);
    if (t < from) continue;
    impulse += dt * engine->step_loads()[1].force.z;
    during += dt;
  }
  std::printf("a cube of %d spacings, %zu particles: at the start accelerations of up to %.2f g\n", across,
              start.size(), fastest / g);
  expect_figure("load at the start / buoyancy", 1, at_once / buoyancy, 0.1);
  expect_figure("mean load / buoyancy", 1, impulse / during / buoyancy, 0.1);
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
}

INSTANTIATE_TEST_SUITE_P(Spacings, Immersed, testing::ValuesIn(spacings({4})));

}  // namespace immersed_test
}  // namespace tandem::test
