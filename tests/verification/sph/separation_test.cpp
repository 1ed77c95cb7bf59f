// Rows and films of liquid that leave a wall at more than a tenth of the speed of sound, as behind an impact:
// they expand while the wall still sees them, and must neither be thrown nor pass the wall.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/geometry/triangle_mesh.hpp"
#include "particles/io/random.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"

namespace tandem::test {
namespace separation_test {

using namespace sph;

// Two walls that meet at `angle` [rad] in the y axis: the floor z = 0, x > 0, and the side. The liquid is
// `along` rows of particles along y and `layers` of them away from the floor, the first at the distances
// `from_floor` and `from_side` of a spacing. It moves with `velocity`, in units of the speed of sound.
struct Leaving {
  const char* what;
  double angle;
  int along, rows, layers;
  double from_floor, from_side;
  Vec3d velocity;
  double faster = 0.05;  // tolerance of the largest speed / that at the start - 1
};

struct Left {
  double fastest = 0;  // largest speed / that at the start
  double kept = 0;     // mean velocity along that at the start / that at the start, at the end
  double passed = 0;
};

Left leave(const Leaving& c, std::uint64_t seed) {
  particles::Random random(seed);
  const Vec3d axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  const Mat3d turn = seed == 0 ? Mat3d::identity() : exp(random.uniform(0, 3) * normalized(axis)).matrix();
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = 0.03;
  l.sound_speed = 30;
  l.artificial = 0.02;
  const double a = l.spacing, size = 20 * a, s = std::sin(c.angle), k = std::cos(c.angle);
  TriangleMesh walls;
  walls.vertices = {{0, -size, 0},
                    {0, size, 0},
                    {size, -size, 0},
                    {size, size, 0},
                    {k * size, -size, s * size},
                    {k * size, size, s * size}};
  walls.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}};
  for (Vec3d& v : walls.vertices) v = turn * v;
  setup.walls = {walls};
  setup.slip = {true};
  setup.domain = {{-2 * size, -2 * size, -2 * size}, {2 * size, 2 * size, 2 * size}};
  LiquidState start;
  // Distance from the side: x sin(angle) - z cos(angle).
  const double x0 = (c.from_side + c.from_floor * k) / s;
  for (int n = 0; n < c.layers; ++n)
    for (int m = 0; m < c.rows; ++m)
      for (int j = 0; j < c.along; ++j) {
        const Vec3d x{x0 + m + n * k / s, j - 0.5 * (c.along - 1), c.from_floor + n};
        start.position.push_back(turn * (a * x));
        start.velocity.push_back(l.sound_speed * (turn * c.velocity));
        start.compression.push_back(0);
      }
  const auto engine = make_engine(setup, true);
  engine->set_state(start);
  const double speed = l.sound_speed * norm(c.velocity);
  Left left;
  for (double t = 0; t < 6 * a / speed;) {
    const StepFigures f = engine->figures();
    left.fastest = std::max(left.fastest, f.largest_speed / speed);
    const double dt = step_limits(l, f.largest_speed, f.largest_acceleration).smallest;
    t += dt;
    engine->step(dt);
  }
  const Vec3d way = (1 / speed) * (l.sound_speed * (turn * c.velocity));
  for (const Vec3d& v : engine->state().velocity)
    left.kept += dot(v, way) / speed / static_cast<double>(start.size());
  left.passed = static_cast<double>(engine->figures().passed_walls);
  return left;
}

constexpr double pi = std::numbers::pi;

TEST(Separation, OfRowsAndFilmsFromWallsThrowsNothing) {
  const Leaving cases[] = {
      {"row on a plane", pi / 2, 11, 1, 1, 0.25, 8, {0, 0, 0.15}},
      {"film of one layer on a plane", pi / 2, 9, 9, 1, 0.25, 5, {0, 0, 0.15}},
      {"film of two layers on a plane", pi / 2, 9, 9, 2, 0.25, 5, {0, 0, 0.15}},
      {"row in an edge of 90 degrees, off the floor", pi / 2, 11, 1, 1, 0.25, 0.25, {0, 0, 0.15}},
      {"row in an edge of 90 degrees, off both walls", pi / 2, 11, 1, 1, 0.25, 0.25, {0.106, 0, 0.106}},
      {"film in an edge of 90 degrees", pi / 2, 9, 5, 1, 0.25, 0.25, {0, 0, 0.15}},
      {"row in an edge of 30 degrees", pi / 6, 11, 1, 1, 0.5, 0.5, {0.145, 0, 0.039}},
      {"film in an edge of 30 degrees", pi / 6, 9, 4, 1, 0.5, 0.5, {0.145, 0, 0.039}, 0.35},
  };
  for (const Leaving& c : cases) {
    double fastest = 0, kept = 1e9, passed = 0;
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const Left one = leave(c, seed);
      fastest = std::max(fastest, one.fastest);
      kept = std::min(kept, one.kept);
      passed += one.passed;
    }
    std::printf("%s\n", c.what);
    expect_figure("largest speed / that at the start", 1, fastest, c.faster);
    expect_figure("mean velocity / that at the start", 1, kept, 0.5);
    expect_figure("particles that passed a wall", 0, passed, 0);
  }
}

}  // namespace separation_test
}  // namespace tandem::test
