// A dam break whose front hits a wall with sensors of pressure, against the repetitions of [Lobovsky2014],
// whose data are beside the project.
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
#include "tests/verification/sph/measured.hpp"

namespace tandem::test {
namespace impact_test {

using namespace sph;

constexpr double g = 9.81, H = 0.3, column = 0.6, tank = 1.61, tank_height = 0.6;  // [m]
constexpr std::array sensor_height{0.003, 0.015, 0.030, 0.080};                    // [m]
constexpr double end = 5;                                                          // times are t sqrt(g/H)
constexpr double sample = 0.005;

// Pressure of each sensor / (rho g H) at the times 0, sample, ...
using Record = std::vector<std::array<double, sensor_height.size()>>;

// A slice of the tank, periodic along y, with `high` spacings over the height of the column.
Record run(int high) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = H / high;
  l.gravity = {0, 0, -g};
  l.sound_speed = suggested_sound_speed(2 * std::sqrt(g * H), g, H);
  l.artificial = 0.02;
  setup.slip = {true};
  const double breadth = 10 * l.spacing;
  setup.walls = {transformed(box_mesh({tank, 3 * breadth, tank_height}, {"+y", "-y", "+z"}),
                             Pose{{tank / 2, breadth / 2, tank_height / 2}, {}})};
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
  const std::vector<dem::BodyPose> poses(2, dem::BodyPose{{}, Mat3d::identity(), {}, {}});
  const auto engine = make_liquid_engine(setup, true);
  engine->set_state(fill_region(gated, poses, region, {H, {}}));
  const Walls walls(setup.walls, l.support());
  const double unit = std::sqrt(H / g);
  Record record;
  double t = 0, fastest = 0, density = 0;
  std::uint64_t steps = 0;
  for (int k = 0; sample * k <= end; ++k) {
    while (t < sample * k * unit - 1e-12) {
      const StepFigures figures = engine->figures();
      const double step =
          std::min(step_limits(l, figures.largest_speed, figures.largest_acceleration).smallest,
                   sample * k * unit - t);
      engine->step(step);
      t += step;
      ++steps;
      fastest = std::max(fastest, engine->figures().largest_speed);
      density = std::max(density, engine->figures().largest_compression);
    }
    const LiquidState state = engine->state();
    const Probe probe(state, l, setup.periods, walls);
    auto& row = record.emplace_back();
    for (std::size_t s = 0; s < sensor_height.size(); ++s)
      row[s] = probe.pressure_at({tank, breadth / 2, sensor_height[s]}) / (l.density * g * H);
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
double time_of_impact(const Record& record, std::size_t sensor) {
  for (std::size_t k = 0; k < record.size(); ++k)
    if (record[k][sensor] > 0.5) return sample * static_cast<double>(k);
  return 0;
}

double mean(const Record& record, std::size_t sensor, double from, double to) {
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < record.size(); ++k)
    if (const double t = sample * static_cast<double>(k); t >= from && t < to) {
      sum += record[k][sensor];
      ++count;
    }
  return sum / count;
}

class Impact : public testing::TestWithParam<int> {};

TEST_P(Impact, OnTheFarWall) {
  const auto measured = measured_rows("dambreak_lobovsky2014/sensor2_H300_percentiles.csv");
  if (measured.empty()) GTEST_SKIP() << "the data of [Lobovsky2014] are not beside the project";
  const Record record = run(GetParam());
  constexpr std::size_t second = 1;
  const auto impact = std::ranges::find_if(measured, [](const auto& row) { return row[2] > 0.5; });
  expect_figure("time of impact, sensor 2, / experiment", 1, time_of_impact(record, second) / impact->at(0),
                0.02);
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
    inside += record[k][second] >= row[1] && record[k][second] <= row[3] ? 1 : 0;
  }
  for (const auto& row : record) highest = std::max(highest, row[second]);
  std::printf("  share of the rows from 2.2 to %.1f in the band of the repetitions: %.3f\n", end,
              inside / counted);
  std::printf("  largest pressure of sensor 2: %.3f, median of the repetitions %.3f\n", highest,
              highest_measured);
  for (std::size_t s = 0; s < sensor_height.size(); ++s)
    std::printf("  sensor %zu: pressure at 2.6, 3, 3.5, 4, 4.5: %.3f %.3f %.3f %.3f %.3f\n", s + 1,
                mean(record, s, 2.55, 2.65), mean(record, s, 2.95, 3.05), mean(record, s, 3.45, 3.55),
                mean(record, s, 3.95, 4.05), mean(record, s, 4.45, 4.55));
  expect_figure("pressure from 4 to 5, sensor 2, / experiment", 1,
                mean(record, second, 4, 5) / (plateau / of_plateau), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Spacings, Impact, testing::Values(10, 15));

}  // namespace impact_test
}  // namespace tandem::test
