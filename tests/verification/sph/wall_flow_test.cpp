// Flows between two parallel walls: start-up of Couette and Poiseuille flow against their series
// [Morris1997].
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"

namespace tandem::test {
namespace wall_flow_test {

using namespace sph;

constexpr double gap = 1, speed = 1, viscosity = 0.2;  // [m], [m/s], [Pa s] of a liquid of 1 kg/m3

// A liquid between the walls z = 0 (body 0) and z = gap (body 1), periodic along x and y.
struct Channel {
  LiquidSetup setup;
  LiquidState start;
  explicit Channel(int across) {
    constexpr int along = 11;
    Liquid& l = setup.liquid;
    l.density = 1;
    l.viscosity = viscosity;
    l.spacing = gap / across;
    l.sound_speed = suggested_sound_speed(speed, 0, 0);
    const double length = along * l.spacing;
    setup.domain = {{0, 0, -l.spacing}, {length, length, gap + l.spacing}};
    setup.periods.min = setup.domain.min;
    setup.periods.length = {length, length, 0};
    for (const double z : {0.0, gap}) {
      TriangleMesh plate;
      plate.vertices = {{-length, -length, z},
                        {2 * length, -length, z},
                        {2 * length, 2 * length, z},
                        {-length, 2 * length, z}};
      plate.triangles = {{0, 1, 2}, {0, 2, 3}};
      setup.walls.push_back(plate);
    }
    for (int z = 0; z < across; ++z)
      for (int y = 0; y < along; ++y)
        for (int x = 0; x < along; ++x) {
          start.position.push_back(l.spacing * Vec3d{x + 0.5, y + 0.5, z + 0.5});
          start.velocity.push_back({});
          start.compression.push_back(0);
        }
  }
};

struct Outcome {
  double error = 0;  // root of the mean square of v_x - expected, divided by the speed [-]
  double drag = 0;   // force along x on the wall z = 0, divided by its area [Pa]
};

// Runs to `end` [s]. `top_speed`: of the upper wall, which stays where it is.
template <class Expected>
Outcome run(int across, double end, Vec3d drive, double top_speed, Expected expected) {
  Channel channel(across);
  channel.setup.liquid.gravity = drive;
  const auto engine = make_engine(channel.setup, true);
  auto poses = engine->poses();
  poses[1].v = {top_speed, 0, 0};
  engine->set_state(channel.start, poses);
  const double limit = step_limits(channel.setup.liquid, speed, 0).smallest;
  const int steps = static_cast<int>(std::ceil(end / limit));
  for (int k = 0; k < steps; ++k) engine->step(end / steps, poses);
  Outcome outcome;
  const LiquidState s = engine->state();
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double off = s.velocity[i].x - expected(s.position[i].z);
    outcome.error += off * off;
  }
  outcome.error = std::sqrt(outcome.error / static_cast<double>(s.size())) / speed;
  const double length = channel.setup.periods.length.x;
  outcome.drag = engine->loads()[0].force.x / (length * length);
  return outcome;
}

void print_order(double coarse, double fine) {
  std::printf("  error with 10 spacings %.5f, with 20 %.5f: order %.2f\n", coarse, fine,
              std::log2(coarse / fine));
}

constexpr double pi = std::numbers::pi;

TEST(Couette, StartsAsItsSeriesSays) {
  const double end = 0.5, decay = viscosity * pi * pi / (gap * gap);
  const auto expected = [&](double z) {
    double v = speed * z / gap;
    for (int n = 1; n < 50; ++n)
      v += 2 * speed / (n * pi) * (n % 2 == 0 ? 1 : -1) * std::sin(n * pi * z / gap) *
           std::exp(-decay * n * n * end);
    return v;
  };
  double drag = speed / gap;
  for (int n = 1; n < 50; ++n)
    drag += 2 * speed / gap * (n % 2 == 0 ? 1 : -1) * std::exp(-decay * n * n * end);
  std::printf("Couette flow, %.2f gap^2/nu after the start\n", end * viscosity);
  const Outcome coarse = run(10, end, {}, speed, expected), fine = run(20, end, {}, speed, expected);
  print_order(coarse.error, fine.error);
  expect_figure("error of the velocity / speed, 20 across", 0, fine.error, 0.01);
  expect_figure("drag on the wall at rest / expected", 1, fine.drag / (viscosity * drag), 0.02);
}

TEST(Poiseuille, StartsAsItsSeriesSays) {
  const double end = 0.75, decay = viscosity * pi * pi / (gap * gap);
  const double drive = 8 * viscosity * speed / (gap * gap);  // for the steady peak `speed` [m/s2]
  const auto expected = [&](double z) {
    double v = drive / (2 * viscosity) * z * (gap - z);
    for (int n = 1; n < 50; n += 2)
      v -= 4 * drive * gap * gap / (viscosity * pi * pi * pi * n * n * n) * std::sin(n * pi * z / gap) *
           std::exp(-decay * n * n * end);
    return v;
  };
  double slope = drive * gap / (2 * viscosity);
  for (int n = 1; n < 50; n += 2)
    slope -= 4 * drive * gap / (viscosity * pi * pi * n * n) * std::exp(-decay * n * n * end);
  std::printf("Poiseuille flow, %.2f gap^2/nu after the start\n", end * viscosity);
  const Outcome coarse = run(10, end, {drive, 0, 0}, 0, expected),
                fine = run(20, end, {drive, 0, 0}, 0, expected);
  print_order(coarse.error, fine.error);
  expect_figure("error of the velocity / peak, 20 across", 0, fine.error, 0.02);
  expect_figure("drag on a wall / expected", 1, fine.drag / (viscosity * slope), 0.02);
}

}  // namespace wall_flow_test
}  // namespace tandem::test
