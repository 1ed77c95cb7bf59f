// The tank of SPHERIC benchmark 10, water, lateral impact [Botia2010], moved by the measured roll angle; its
// data are beside the project. The pressure of the sensor is the load on a patch of the side wall around it,
// divided by its area; the pressure of the particles beside the sensor is printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/probe.hpp"
#include "sph_server/equations/time_step.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"
#include "tests/verification/sph/measured.hpp"
#include "tests/verification/sph/spacings.hpp"

namespace tandem::test {
namespace sloshing_test {

using namespace sph;

constexpr double length = 0.9, height = 0.508, depth = 0.093, g = 9.81;  // [m], [m/s2]
constexpr double end = 7.6, sample = 0.002;                              // [s]
constexpr double patch = 0.02;  // height of the patch, whose middle is the sensor [m]

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

// Pressures at the times 0, sample, ... [Pa]: from the load on the patch, mean since the time before, and of
// the particles beside the sensor.
struct Record {
  std::vector<double> load, beside;
};

// Two triangles of the side wall at x < 0, from the height `low` to `high`.
void append_strip(TriangleMesh& m, double low, double high, double breadth) {
  const auto first = static_cast<std::uint32_t>(m.vertices.size());
  for (const auto& [y, z] : {std::pair{-breadth, low}, std::pair{2 * breadth, low},
                             std::pair{2 * breadth, high}, std::pair{-breadth, high}})
    m.vertices.push_back({-length / 2, y, z});
  m.triangles.push_back({first, first + 1, first + 2});
  m.triangles.push_back({first, first + 2, first + 3});
}

// A slice of the tank, periodic along y; it rolls about the middle of its bottom line, and the sensor is on
// the wall at x < 0, which a positive roll lowers.
Record run(int deep, const Roll& roll) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.density = 998;
  l.viscosity = 8.94e-4;
  l.spacing = depth / deep;
  l.gravity = {0, 0, -g};
  // The measured peaks are stagnation pressures of some 3 m/s.
  l.sound_speed = suggested_sound_speed(3, g, depth);
  l.artificial = 0.02;
  setup.slip = {true, true, true};
  const double breadth = 10 * l.spacing;
  setup.walls = {transformed(box_mesh({length, 3 * breadth, height}, {"-x", "+y", "-y"}),
                             Pose{{0, breadth / 2, height / 2}, {}}),
                 {},
                 {}};
  const double low = depth - patch / 2, high = depth + patch / 2;
  append_strip(setup.walls[1], 0, low, breadth);
  append_strip(setup.walls[1], high, height, breadth);
  append_strip(setup.walls[2], low, high, breadth);
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
  const std::vector<particles::BodyPose> rest(3, particles::BodyPose{{}, Mat3d::identity(), {}, {}});
  const auto engine = make_engine(setup, true);
  engine->set_state(fill(setup, rest, region, {depth, {}}), rest);
  Walls walls(setup.walls, l.support());
  Record record;
  double t = 0, impulse = 0, fastest = 0, density = 0;
  std::uint64_t steps = 0;
  for (int k = 0; sample * k <= end; ++k) {
    while (t < sample * k - 1e-12) {
      const StepFigures figures = engine->figures();
      // Equal steps: the method extrapolates by the ratio of a step to the one before.
      const double limit = step_limits(l, figures.largest_speed, figures.largest_acceleration).smallest,
                   left = sample * k - t, step = left / std::ceil(left / limit);
      t += step;
      ++steps;
      const particles::BodyPose pose = pose_at(t);
      engine->step(step, {pose, pose, pose});
      impulse -= dot(engine->step_loads()[2].force, pose.R * Vec3d{1, 0, 0}) * step;
      fastest = std::max(fastest, engine->figures().largest_speed);
      density = std::max(density, engine->figures().largest_compression);
    }
    const LiquidState state = engine->state();
    const particles::BodyPose now = pose_at(t);
    for (std::uint32_t body = 0; body < walls.bodies(); ++body) walls.set_pose(body, now);
    record.load.push_back(impulse / (sample * patch * breadth));
    impulse = 0;
    record.beside.push_back(Probe(state, l, setup.periods, walls)
                                .pressure_at(now.p + now.R * Vec3d{-length / 2, breadth / 2, depth}));
  }
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
  std::printf("%d spacings over the depth, %zu particles, %llu steps: Mach number %.3f, density error %.3f\n",
              deep, engine->state().size(), static_cast<unsigned long long>(steps), fastest / l.sound_speed,
              density);
  return record;
}

struct Peak {
  double pressure = 0, time = 0;  // [Pa], [s]
};
// The largest pressure within 0.4 s of a time.
Peak peak_around(double time, const std::vector<double>& record) {
  Peak peak;
  for (std::size_t i = 0; i < record.size(); ++i)
    if (const double t = sample * static_cast<double>(i);
        std::fabs(t - time) < 0.4 && record[i] > peak.pressure)
      peak = {record[i], t};
  return peak;
}

double correlation(const std::vector<double>& record, const std::vector<std::vector<double>>& series) {
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
  return (n * xy - x * y) / std::sqrt((n * xx - x * x) * (n * yy - y * y));
}

class Sloshing : public testing::TestWithParam<int> {};

TEST_P(Sloshing, LateralImpactsOfWater) {
  const Roll roll{measured_rows("spheric10_lateral_water/lateral_water_roll_5ms.csv")};
  const auto peaks = measured_rows("spheric10_lateral_water/lateral_water_peaks_102runs.csv"),
             series = measured_rows("spheric10_lateral_water/lateral_water_pressure_2ms.csv");
  if (roll.rows.empty() || peaks.empty() || series.empty())
    GTEST_SKIP() << "the data of SPHERIC benchmark 10 are not beside the project";
  const Record record = run(GetParam(), roll);
  std::printf(
      "  pressure: load on a patch of %.1f mm height and the breadth of the slice, %.3g spacings, mean of "
      "%.0f ms\n",
      1000 * patch, patch / depth * GetParam(), 1000 * sample);
  // Each peak is the largest pressure around the measured one.
  constexpr std::array at{2.3749, 4.0668, 5.6718, 7.3032};
  for (std::size_t k = 0; k < at.size(); ++k) {
    double mean = 0, squares = 0;
    for (const auto& row : peaks) mean += row[k] / static_cast<double>(peaks.size());
    for (const auto& row : peaks) squares += (row[k] - mean) * (row[k] - mean);
    const double deviation = std::sqrt(squares / static_cast<double>(peaks.size() - 1));
    const Peak peak = peak_around(at[k], record.load), beside = peak_around(at[k], record.beside);
    std::printf(
        "  peak %zu at %.3f s, measured at %.3f s; of the particles beside the sensor %.4g Pa at %.3f s\n",
        k + 1, peak.time, at[k], beside.pressure, beside.time);
    expect_figure("  its pressure [Pa]", mean, peak.pressure, 2 * deviation);
  }
  std::printf("  correlation of the pressure of the particles beside the sensor: %.3f\n",
              correlation(record.beside, series));
  expect_figure("correlation with the measured series", 1, correlation(record.load, series), 0.3);
}

INSTANTIATE_TEST_SUITE_P(Spacings, Sloshing, testing::ValuesIn(spacings({4, 6})));

}  // namespace sloshing_test
}  // namespace tandem::test
