// A dam break whose front hits a wall with sensors of pressure, against the repetitions of [Lobovsky2014],
// whose data are beside the project. As in the experiment, the pressure of a sensor is the load on a part of
// the wall divided by its area; the pressure of the particles beside it is printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/probe.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/measured.hpp"
#include "tests/verification/sph/spacings.hpp"

namespace tandem::test {
namespace impact_test {

using namespace sph;

constexpr double g = 9.81, H = 0.3, column = 0.6, tank = 1.61, tank_height = 0.6;  // [m]
constexpr std::array sensor_height{0.003, 0.015, 0.030, 0.080};                    // [m]
constexpr double patch = 0.030;  // height of the part of sensor 2, its centre [m]
constexpr double end = 5;        // times are t sqrt(g/H)
constexpr double sample = 0.005;

// Pressures / (rho g H) at the times 0, sample, ...: from the load on the part of the wall around sensor 2,
// mean since the time before, and of the particles beside each sensor.
struct Pressures {
  double load = 0;
  std::array<double, sensor_height.size()> beside{};
};
using Record = std::vector<Pressures>;

// A strip of the far wall.
TriangleMesh strip(double low, double high, double breadth) {
  TriangleMesh m;
  m.vertices = {
      {tank, -breadth, low}, {tank, 2 * breadth, low}, {tank, 2 * breadth, high}, {tank, -breadth, high}};
  m.triangles = {{0, 2, 1}, {0, 3, 2}};
  return m;
}

// A slice of the tank, periodic along y, with `high` spacings over the height of the column.
Record run(int high) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = H / high;
  l.gravity = {0, 0, -g};
  l.sound_speed = suggested_sound_speed(2 * std::sqrt(g * H), g, H);
  l.artificial = 0.02;
  setup.slip = {true, true, true};
  const double breadth = 10 * l.spacing;
  setup.walls = {transformed(box_mesh({tank, 3 * breadth, tank_height}, {"+x", "+y", "-y", "+z"}),
                             Pose{{tank / 2, breadth / 2, tank_height / 2}, {}}),
                 strip(0, patch, breadth), strip(patch, tank_height, breadth)};
  // Larger than the tank: particles that pass a wall are counted, and do not end the run.
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
  const std::vector<particles::BodyPose> poses(4, particles::BodyPose{{}, Mat3d::identity(), {}, {}});
  const auto engine = make_engine(setup, true);
  engine->set_state(fill(gated, poses, region, {H, {}}));
  const Walls walls(setup.walls, l.support());
  const double unit = std::sqrt(H / g);
  Record record;
  double t = 0, impulse = 0, fastest = 0, density = 0;
  std::uint64_t steps = 0;
  for (int k = 0; sample * k <= end; ++k) {
    while (t < sample * k * unit - 1e-12) {
      const StepFigures figures = engine->figures();
      // Equal steps: the method extrapolates by the ratio of a step to the one before.
      const double limit = step_limits(l, figures.largest_speed, figures.largest_acceleration).smallest,
                   left = sample * k * unit - t, step = left / std::ceil(left / limit);
      engine->step(step);
      impulse += engine->step_loads()[1].force.x * step;
      t += step;
      ++steps;
      fastest = std::max(fastest, engine->figures().largest_speed);
      density = std::max(density, engine->figures().largest_compression);
    }
    const LiquidState state = engine->state();
    const Probe probe(state, l, setup.periods, walls);
    Pressures& row = record.emplace_back();
    row.load = impulse / (sample * unit * patch * breadth) / (l.density * g * H);
    impulse = 0;
    for (std::size_t s = 0; s < sensor_height.size(); ++s)
      row.beside[s] = probe.pressure_at({tank, breadth / 2, sensor_height[s]}) / (l.density * g * H);
  }
  const EnergyBalance e = engine->energies();
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
  std::printf(
      "%d spacings over the height, %zu particles, %llu steps: Mach number %.3f, density error %.3f, volume "
      "/ that at rest %.4f, energy from ghosts / work of gravity %.4f\n",
      high, engine->state().size(), static_cast<unsigned long long>(steps), fastest / l.sound_speed, density,
      engine->volume() * l.density / (static_cast<double>(engine->state().size()) * l.mass()),
      e.ghost / e.gravity);
  return record;
}

// First time at which the pressure is above half of rho g H.
double time_of_impact(const Record& record) {
  for (std::size_t k = 0; k < record.size(); ++k)
    if (record[k].load > 0.5) return sample * static_cast<double>(k);
  return 0;
}

// Of all samples at times from `from` and below `to`.
template <class Value>
double mean(const Record& record, double from, double to, Value value) {
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < record.size(); ++k)
    if (const double t = sample * static_cast<double>(k); t >= from && t < to) {
      sum += value(record[k]);
      ++count;
    }
  return sum / count;
}
double load(const Pressures& p) {
  return p.load;
}

class Impact : public testing::TestWithParam<int> {};

TEST_P(Impact, OnTheFarWall) {
  const auto measured = measured_rows("dambreak_lobovsky2014/sensor2_H300_percentiles.csv");
  if (measured.empty()) GTEST_SKIP() << "the data of [Lobovsky2014] are not beside the project";
  const Record record = run(GetParam());
  const auto impact = std::ranges::find_if(measured, [](const auto& row) { return row[2] > 0.5; });
  expect_figure("time of impact, sensor 2, / experiment", 1, time_of_impact(record) / impact->at(0), 0.02);
  double inside = 0, counted = 0, plateau = 0, of_plateau = 0, highest = 0, highest_measured = 0;
  for (const auto& row : measured) {
    highest_measured = std::max(highest_measured, row[2]);
    if (row[0] >= 4 && row[0] < 5) {
      plateau += row[2];
      ++of_plateau;
    }
    const auto k = static_cast<std::size_t>(std::lround(row[0] / sample));
    if (row[0] < 2.2 || k >= record.size()) continue;
    ++counted;
    inside += record[k].load >= row[1] && record[k].load <= row[3] ? 1 : 0;
  }
  for (const auto& row : record) highest = std::max(highest, row.load);
  std::printf("  share of the rows from 2.2 to %.1f in the band of the repetitions: %.3f\n", end,
              inside / counted);
  std::printf("  largest pressure of sensor 2: %.3f, median of the repetitions %.3f\n", highest,
              highest_measured);
  std::printf("  pressure of sensor 2 at 2.6, 3, 3.5, 4, 4.5: %.3f %.3f %.3f %.3f %.3f\n",
              mean(record, 2.55, 2.65, load), mean(record, 2.95, 3.05, load), mean(record, 3.45, 3.55, load),
              mean(record, 3.95, 4.05, load), mean(record, 4.45, 4.55, load));
  plateau /= of_plateau;
  for (std::size_t s = 0; s < sensor_height.size(); ++s)
    std::printf(
        "  pressure of the particles beside sensor %zu, from 4 to 5, / that of sensor 2 in the experiment: "
        "%.3f\n",
        s + 1, mean(record, 4, 5, [&](const Pressures& p) { return p.beside[s]; }) / plateau);
  expect_figure("pressure from 4 to 5, sensor 2, / experiment", 1, mean(record, 4, 5, load) / plateau, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Spacings, Impact, testing::ValuesIn(spacings({10, 15})));

}  // namespace impact_test
}  // namespace tandem::test
