// A piston presses a liquid without gravity through a slot in the floor of a channel twice as wide. The
// pressure on it and the width of the steady jet are known in closed form: the jet has the velocity of
// Bernoulli's law, and contracts to C times the slot [Mises1917]:
//   1/C = 1 + 2/pi (1/u - u) atan(u), with the velocity u = C (slot / channel) of the piston over that of the
//   jet
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/spacings.hpp"

namespace tandem::test {
namespace slot_test {

using namespace sph;

constexpr double slot_by_channel = 0.5;

double contraction() {
  double C = 0.6;
  for (int k = 0; k < 50; ++k) {
    const double u = C * slot_by_channel;
    C = 1 / (1 + 2 / std::numbers::pi * (1 / u - u) * std::atan(u));
  }
  return C;
}

void append_quad(TriangleMesh& m, Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
  const auto first = static_cast<std::uint32_t>(m.vertices.size());
  m.vertices.insert(m.vertices.end(), {a, b, c, d});
  m.triangles.push_back({first, first + 1, first + 2});
  m.triangles.push_back({first, first + 2, first + 3});
}

class Slot : public testing::TestWithParam<int> {};

// One half of the channel, x from 0, a plane of symmetry, to 1; periodic along y. Lengths in widths D of the
// slot, which has `across` spacings; the density is 1, and the jet of closed form has the velocity 1.
TEST_P(Slot, PassesWhatItsContractionAllows) {
  const int across = GetParam();
  ASSERT_EQ(across % 2, 0) << "half a slot has whole spacings";
  constexpr double depth = 3.5, wide = 1, half = 0.5 * slot_by_channel * 2 * wide, low = -8, up = depth + 1;
  constexpr double ramp = 1, steady = 3, end = 7.5;  // [D / velocity of the jet]
  const double C = contraction(), u = C * slot_by_channel;
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.density = 1;
  l.spacing = 1.0 / across;
  l.sound_speed = 10;
  const double a = l.spacing, breadth = 10 * a;
  TriangleMesh vessel, piston;
  append_quad(vessel, {0, -1, low}, {0, breadth + 1, low}, {0, breadth + 1, up}, {0, -1, up});
  append_quad(vessel, {wide, -1, 0}, {wide, breadth + 1, 0}, {wide, breadth + 1, up}, {wide, -1, up});
  append_quad(vessel, {half, -1, 0}, {wide, -1, 0}, {wide, breadth + 1, 0}, {half, breadth + 1, 0});
  append_quad(piston, {-1, -1, 0}, {wide + 1, -1, 0}, {wide + 1, breadth + 1, 0}, {-1, breadth + 1, 0});
  setup.walls = {vessel, piston};
  setup.slip = {true, true};
  setup.domain = {{-10, 0, -40}, {10, breadth, up}};
  setup.periods.min = setup.domain.min;
  setup.periods.length = {0, breadth, 0};
  LiquidState start;
  const int high = static_cast<int>(std::lround(depth * across));
  for (int k = 0; k < across * 10 * high; ++k) {
    start.position.push_back(a * Vec3d{k % across + 0.5, k / across % 10 + 0.5, k / across / 10 + 0.5});
    start.velocity.push_back({});
    start.compression.push_back(0);
  }
  std::vector<particles::BodyPose> pose(2, particles::BodyPose{{}, Mat3d::identity(), {}, {}});
  double height = high * a, speed = 0;
  pose[1].p.z = height;
  const auto engine = make_engine(setup, true);
  engine->set_state(start, pose);
  double impulse = 0, during = 0, density = 0;
  for (double t = 0; t < end;) {
    const StepFigures f = engine->figures();
    density = std::max(density, f.largest_compression);
    const double dt = 0.95 * step_limits(l, f.largest_speed, f.largest_acceleration).smallest;
    t += dt;
    const double next = u * std::min(1.0, t / ramp);
    height -= 0.5 * dt * (speed + next);
    speed = next;
    pose[1].p.z = height;
    pose[1].v.z = -speed;
    engine->step(dt, pose);
    if (t < steady) continue;
    impulse += dt * engine->step_loads()[1].force.z;
    during += dt;
  }
  // The jet that has this pressure behind it, and the width that passes the flow of the piston.
  const double pressure = impulse / during / (wide * breadth), jet = std::sqrt(2 * pressure + u * u),
               passed = speed * wide / (half * jet);
  std::printf(
      "%d spacings across the slot, %zu particles: pressure on the piston / closed form %.3f, density "
      "error %.3f; the slot lacks %.2f spacings\n",
      across, start.size(), pressure / (0.5 * (1 - u * u)), density, across * (1 - passed / C));
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
  expect_figure("flow / closed form at the same pressure", 1, passed / C, 0.06);
}

INSTANTIATE_TEST_SUITE_P(Spacings, Slot, testing::ValuesIn(spacings({4, 6})));

}  // namespace slot_test
}  // namespace tandem::test
