#include "coordinator/results/checks.hpp"

#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/error.hpp"
#include "coordinator/results/reduction.hpp"
#include "tests/unit/results/toy_run.hpp"

namespace tandem::launch {
namespace {

struct Signal {
  std::vector<double> time, value;
};

template <class Function>
Signal sampled(double end, int steps, Function f) {
  Signal signal;
  for (int i = 0; i <= steps; ++i) {
    signal.time.push_back(end * i / steps);
    signal.value.push_back(f(signal.time.back()));
  }
  return signal;
}

double reduced(const Signal& signal, const char* how, double from = 0, double to = 0) {
  return reduce(signal.time, signal.value, how, from, to);
}

void expect_close(const char* what, double measured, double expected, double tolerance) {
  std::printf("%-44s expected %.15g measured %.15g tolerance %g\n", what, expected, measured, tolerance);
  EXPECT_NEAR(measured, expected, tolerance);
}

TEST(Reduce, MeanIsTheTimeMean) {
  // Exact for a straight line, also on uneven steps: integral of 2 + 3 t over [0, 2] / 2 = 5.
  const Signal line{{0, 0.1, 0.7, 2}, {2, 2.3, 4.1, 8}};
  expect_close("mean of a line on uneven steps", reduced(line, "mean"), 5, 1e-14);
  // The trapezoid's error on sin over [0, pi] is h^2/12 [cos]: mean 2/pi (1 - h^2/12).
  const int steps = 1000;
  const Signal arch = sampled(std::numbers::pi, steps, [](double t) { return std::sin(t); });
  const double h = std::numbers::pi / steps;
  expect_close("mean of an arch of sine", reduced(arch, "mean"), 2 / std::numbers::pi * (1 - h * h / 12),
               1e-12);
}

// The trapezoid is exact for the squares of a sine at steps that divide its period: A / sqrt(2). Of its
// absolute value it is exact but for h^2/12 at each zero, as in the arch above: 2 A / pi (1 - h^2/12).
TEST(Reduce, RmsAndMeanOfTheAbsoluteValueAreOverTime) {
  const double A = 3;
  const int steps = 1000;
  const Signal sine = sampled(2 * std::numbers::pi, steps, [&](double t) { return A * std::sin(t); });
  const double h = 2 * std::numbers::pi / steps;
  expect_close("rms of a sine", reduced(sine, "rms"), A / std::sqrt(2.0), 1e-13);
  expect_close("mean of the absolute value of a sine", reduced(sine, "mean_abs"),
               2 * A / std::numbers::pi * (1 - h * h / 12), 1e-9);
  // Rows at uneven times: 1 for 3 s and -2 for 1 s, with jumps that take no time.
  const Signal steps_of{{0, 3, 3, 4}, {1, 1, -2, -2}};
  expect_close("rms over uneven rows", reduced(steps_of, "rms"), std::sqrt(7.0 / 4), 1e-15);
  expect_close("mean of the absolute value over uneven rows", reduced(steps_of, "mean_abs"), 5.0 / 4, 1e-15);
  EXPECT_EQ(reduced({{0, 1}, {5, -4}}, "rms", 1), 4) << "a single row";
  EXPECT_EQ(reduced({{0, 1}, {5, -4}}, "mean_abs", 1), 4);
}

TEST(Reduce, ExtremesRangeAndLast) {
  const Signal signal{{0, 1, 2, 3}, {4, -7, 9, 5}};
  EXPECT_EQ(reduced(signal, "last"), 5);
  EXPECT_EQ(reduced(signal, "min"), -7);
  EXPECT_EQ(reduced(signal, "max"), 9);
  EXPECT_EQ(reduced(signal, "range"), 16);
}

TEST(Reduce, RangeOfTimeIncludesRowsAtItsEnds) {
  const Signal signal{{0, 0.1, 0.2, 0.30000000000000004, 0.4}, {100, 1, 2, 3, 100}};
  EXPECT_EQ(reduced(signal, "max", 0.1, 0.3), 3);
  EXPECT_EQ(reduced(signal, "min", 0.1, 0.3), 1);
  EXPECT_EQ(reduced(signal, "max", 0.1), 100) << "to = 0 means the end";
  EXPECT_EQ(reduced(signal, "mean", 0.2, 0.2), 2) << "a single row is its own mean";
}

TEST(Reduce, PeriodOfAnOffsetOscillation) {
  const double period = 0.37;
  const Signal signal = sampled(
      10, 5000, [&](double t) { return 12 + 0.3 * std::sin(2 * std::numbers::pi * t / period + 0.4); });
  expect_close("period of a sine, 185 samples a period", reduced(signal, "period"), period, 1e-5 * period);
}

TEST(Reduce, PeriodOfASawtoothIsExact) {
  // Straight pieces: linear interpolation finds the crossings exactly.
  const Signal signal{{0, 1, 2, 3, 4, 5, 6}, {-1, 1, -1, 1, -1, 1, -1}};
  expect_close("period of a triangle wave", reduced(signal, "period"), 2, 1e-14);
}

TEST(Reduce, PeriodWithoutTwoCrossingsIsNotANumber) {
  EXPECT_TRUE(std::isnan(reduced(sampled(1, 10, [](double t) { return t; }), "period")));
  EXPECT_TRUE(std::isnan(reduced(sampled(1, 10, [](double) { return 5.0; }), "period")));
}

TEST(Reduce, WhatIsNoNumberIsNotPassedOver) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<double>& values :
       {std::vector{nan, 1., 2.}, std::vector{1., nan, 2.}, std::vector{1., 2., nan}})
    for (const char* how : {"min", "max", "range", "mean", "rms", "mean_abs"})
      EXPECT_TRUE(std::isnan(reduced({{0, 1, 2}, values}, how))) << how;
}

TEST(Reduce, EmptyRangeIsASceneError) {
  const Signal signal{{0, 1}, {0, 1}};
  try {
    reduced(signal, "mean", 2, 3);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::scene);
    EXPECT_EQ(error.problem(), "no window ends in the range from 2 s to 3 s");
  }
}

scene::Check with(scene::Check check, const scene::CheckKeys& keys) {
  static_cast<scene::CheckKeys&>(check) = keys;
  return check;
}

class Evaluate : public ::testing::Test {
 protected:
  CheckResult judge(const scene::Check& check) {
    Signals bodies(folder_ / "bodies.csv", {"time", "box.position.z"});
    Signals joints(folder_ / "joints.csv", {"time", "hinge.q"});
    for (int i = 1; i <= 4; ++i) {
      bodies.append({0.1 * i, 10.0 * i});
      joints.append({0.1 * i, -1.0 * i});
    }
    const nlohmann::json summary = {{"lost_particles", 3}, {"time_split", {{"dem", 0.75}}}, {"status", "ok"}};
    return evaluate({check}, {&bodies, &joints}, summary).at(0);
  }
  void expect_error(const scene::Check& check, const std::string& text) {
    try {
      judge(check);
      FAIL() << "no error for " << check.of;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::scene);
      EXPECT_EQ(error.where(), "checks[0] \"c\"");
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }

 private:
  toy::Folder folder_;
};

TEST_F(Evaluate, ReadsBodiesJointsAndSummary) {
  EXPECT_EQ(judge({.name = "c", .of = "box.position.z"}).value, 40);
  EXPECT_EQ(judge({.name = "c", .of = "hinge.q", .reduce = "max"}).value, -1);
  EXPECT_EQ(judge({.name = "c", .of = "summary.lost_particles"}).value, 3);
  EXPECT_EQ(judge({.name = "c", .of = "summary.time_split.dem"}).value, 0.75);
}

TEST_F(Evaluate, RelativeAndAbsoluteTolerance) {
  const CheckResult relative =
      judge(with({.name = "c", .of = "box.position.z", .expected = 50}, {.tolerance = 0.25}));
  EXPECT_DOUBLE_EQ(relative.error, 0.2);
  EXPECT_TRUE(relative.passed);
  EXPECT_FALSE(judge(with({.name = "c", .of = "box.position.z", .expected = 50}, {.tolerance = 0.1})).passed);
  const CheckResult absolute =
      judge(with({.name = "c", .of = "hinge.q", .expected = -4.5}, {.absolute = true, .tolerance = 0.25}));
  EXPECT_DOUBLE_EQ(absolute.error, 0.5);
  EXPECT_FALSE(absolute.passed);
}

TEST_F(Evaluate, ExpectsAnotherSignalTimesAFactor) {
  // box.position.z ends at 40, the largest hinge.q is -1.
  const CheckResult result =
      judge(with({.name = "c", .of = "box.position.z", .expected_of = "summary.lost_particles", .times = 13},
                 {.tolerance = 0.03}));
  EXPECT_EQ(result.check.expected, 39);
  EXPECT_DOUBLE_EQ(result.error, 1.0 / 39);
  EXPECT_TRUE(result.passed);
  EXPECT_EQ(
      judge({.name = "c", .of = "box.position.z", .reduce = "max", .expected_of = "hinge.q"}).check.expected,
      -1);
  expect_error({.name = "c", .of = "box.position.z", .expected_of = "box.position.x"}, "box.position.z");
}

TEST_F(Evaluate, ExpectedZero) {
  EXPECT_FALSE(
      judge(with({.name = "c", .of = "summary.lost_particles", .expected = 0}, {.tolerance = 1})).passed);
  EXPECT_TRUE(judge(with({.name = "c", .of = "summary.lost_particles", .expected = 0},
                         {.absolute = true, .tolerance = 3}))
                  .passed);
}

TEST_F(Evaluate, AValueThatIsNoNumberFails) {
  const CheckResult result =
      judge(with({.name = "c", .of = "hinge.q", .reduce = "period", .expected = 1}, {.tolerance = 1e9}));
  EXPECT_TRUE(std::isnan(result.value));
  EXPECT_FALSE(result.passed);
}

TEST_F(Evaluate, WrongChecksNameThemselvesAndTheRemedy) {
  expect_error({.name = "c", .of = "box.position.x"}, "box.position.z");
  expect_error({.name = "c", .of = "summary.lost_partcles"}, "lost_particles");
  expect_error({.name = "c", .of = "summary.status"}, "is no number");
  expect_error({.name = "c", .of = "hinge.q", .reduce = "men"}, "mean");
  expect_error(with({.name = "c", .of = "hinge.q"}, {.from = 7}), "from 7 s to the end");
}

}  // namespace
}  // namespace tandem::launch
