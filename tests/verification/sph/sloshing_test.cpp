// The tank of SPHERIC benchmark 10, water, lateral impact [Botia2010], moved by the measured roll angle; its
// data are beside the project.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/probe.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/measured.hpp"

namespace tandem::test {
namespace sloshing_test {

using namespace sph;

constexpr double length = 0.9, height = 0.508, depth = 0.093, g = 9.81;  // [m], [m/s2]
constexpr double end = 7.6, sample = 0.002;                              // [s]

// Roll angle [rad] and its rate [rad/s]: cubic through the samples with the slopes of their neighbours.
struct Roll {
  std::vector<std::vector<double>> rows;
  std::array<double, 2> operator()(double t) const {
    const double step = rows[1][0] - rows[0][0];
    const auto last = static_cast<std::ptrdiff_t>(rows.size()) - 1;
    const auto at = [&](std::ptrdiff_t k) {
      return rows[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))][1] * std::numbers::pi /
             180;
    };
    const auto k = static_cast<std::ptrdiff_t>(std::floor(t / step));
    const double s = t / step - static_cast<double>(k), a = at(k), b = at(k + 1), da = 0.5 * (b - at(k - 1)),
                 db = 0.5 * (at(k + 2) - a);
    return {a + s * (da + s * (3 * (b - a) - 2 * da - db + s * (2 * (a - b) + da + db))),
            (da + s * (2 * (3 * (b - a) - 2 * da - db) + 3 * s * (2 * (a - b) + da + db))) / step};
  }
};

// Pressure at the sensor [Pa] at the times 0, sample, ... A slice of the tank, periodic along y; it rolls
// about the middle of its bottom line, and the sensor is on the wall at x < 0, which a positive roll lowers.
std::vector<double> run(int deep, const Roll& roll) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.density = 998;
  l.viscosity = 8.94e-4;
  l.spacing = depth / deep;
  l.gravity = {0, 0, -g};
  // The measured peaks are stagnation pressures of some 3 m/s.
  l.sound_speed = suggested_sound_speed(3, g, depth);
  l.artificial = 0.02;
  setup.slip = {true};
  const double breadth = 10 * l.spacing;
  setup.walls = {transformed(box_mesh({length, 3 * breadth, height}, {"+y", "-y"}),
                             Pose{{0, breadth / 2, height / 2}, {}})};
  // Larger than the tank: particles that pass a wall are counted, and do not end the run.
  setup.domain = {{-2 * length, 0, -4 * height}, {2 * length, breadth, 4 * height}};
  setup.periods.min = setup.domain.min;
  setup.periods.length = {0, breadth, 0};
  const TriangleMesh region =
      transformed(box_mesh({length, breadth, depth}), Pose{{0, breadth / 2, depth / 2}, {}});
  const auto pose_at = [&](double t) {
    const auto [angle, rate] = roll(t);
    // A positive roll lowers the side of x < 0: a rotation by -angle about y.
    const Quat q{std::cos(angle / 2), 0, -std::sin(angle / 2), 0};
    return particles::BodyPose{{}, q.matrix(), {}, {0, -rate, 0}};
  };
  // The start of the record is at rest up to its noise.
  LiquidSetup level = setup;
  const std::vector<particles::BodyPose> rest{{{}, Mat3d::identity(), {}, {}}};
  const auto engine = make_engine(setup, true);
  engine->set_state(fill_region(level, rest, region, {depth, {}}), rest);
  Walls walls(setup.walls, l.support());
  std::vector<double> record;
  double t = 0, fastest = 0, density = 0;
  std::uint64_t steps = 0;
  for (int k = 0; sample * k <= end; ++k) {
    while (t < sample * k - 1e-12) {
      const StepFigures figures = engine->figures();
      // Equal steps: the method extrapolates by the ratio of a step to the one before.
      const double limit = step_limits(l, figures.largest_speed, figures.largest_acceleration).smallest,
                   left = sample * k - t, step = left / std::ceil(left / limit);
      t += step;
      ++steps;
      engine->step(step, {pose_at(t)});
      fastest = std::max(fastest, engine->figures().largest_speed);
      density = std::max(density, engine->figures().largest_compression);
    }
    const LiquidState state = engine->state();
    walls.set_pose(0, pose_at(t));
    const particles::BodyPose& now = walls.poses()[0];
    record.push_back(Probe(state, l, setup.periods, walls)
                         .pressure_at(now.p + now.R * Vec3d{-length / 2, breadth / 2, depth}));
  }
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
  std::printf("%d spacings over the depth, %zu particles, %llu steps: Mach number %.3f, density error %.3f\n",
              deep, engine->state().size(), static_cast<unsigned long long>(steps), fastest / l.sound_speed,
              density);
  return record;
}

class Sloshing : public testing::TestWithParam<int> {};

TEST_P(Sloshing, LateralImpactsOfWater) {
  const Roll roll{measured_rows("spheric10_lateral_water/lateral_water_roll_5ms.csv")};
  const auto peaks = measured_rows("spheric10_lateral_water/lateral_water_peaks_102runs.csv"),
             series = measured_rows("spheric10_lateral_water/lateral_water_pressure_2ms.csv");
  if (roll.rows.empty() || peaks.empty() || series.empty())
    GTEST_SKIP() << "the data of SPHERIC benchmark 10 are not beside the project";
  const std::vector<double> record = run(GetParam(), roll);
  // Each peak is the largest pressure around the measured one.
  constexpr std::array at{2.3749, 4.0668, 5.6718, 7.3032};
  for (std::size_t k = 0; k < at.size(); ++k) {
    double mean = 0, squares = 0, largest = 0, when = 0;
    for (const auto& row : peaks) mean += row[k] / static_cast<double>(peaks.size());
    for (const auto& row : peaks) squares += (row[k] - mean) * (row[k] - mean);
    const double deviation = std::sqrt(squares / static_cast<double>(peaks.size() - 1));
    for (std::size_t i = 0; i < record.size(); ++i)
      if (const double t = sample * static_cast<double>(i);
          std::fabs(t - at[k]) < 0.4 && record[i] > largest) {
        largest = record[i];
        when = t;
      }
    std::printf("  peak %zu at %.3f s, measured at %.3f s\n", k + 1, when, at[k]);
    expect_figure("  its pressure [Pa]", mean, largest, 2 * deviation);
  }
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  for (std::size_t i = 0; i < std::min(record.size(), series.size()); ++i) {
    const double a = record[i], b = series[i][1];
    ++n;
    x += a;
    y += b;
    xx += a * a;
    yy += b * b;
    xy += a * b;
  }
  const double correlation = (n * xy - x * y) / std::sqrt((n * xx - x * x) * (n * yy - y * y));
  expect_figure("correlation with the measured series", 1, correlation, 0.3);
}

INSTANTIATE_TEST_SUITE_P(Spacings, Sloshing, testing::Values(4, 6));

}  // namespace sloshing_test
}  // namespace tandem::test
