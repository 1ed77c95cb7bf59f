// Functions of time of motions and forces: their derivatives, their ends, speeds, breaks.
#include "common/scene/motion_function.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"

namespace tandem::scene {
namespace {

using Jumps = std::vector<MotionFunction::RateJump>;

const std::vector<double> times{0, .2, .5, .6, 1}, values{0, 1, -1, .5, .3};

TableMotion table(Interpolation interpolation, MotionOf of = MotionOf::position) {
  const bool smooth = interpolation == Interpolation::linear || interpolation == Interpolation::step;
  return {times, values, interpolation, smooth ? .08 : 0, of, of == MotionOf::speed ? .7 : 0};
}

const std::vector<Interpolation> all{Interpolation::monotone, Interpolation::linear, Interpolation::step,
                                     Interpolation::spline};

int jumps_of_acceleration(const MotionFunction& f) {
  int jumps = 0;
  for (const double t : f.breaks())
    jumps += std::abs(f.at(t, t).acceleration - f.at(t, t - 1e-3).acceleration) > 1e-9;
  return jumps;
}

TEST(MotionFunction, DerivativesBelongToTheValues) {
  std::vector<Motion> motions{ConstantMotion{1, 2}, RampMotion{.5, 2, .1, .8},
                              RampMotion{.5, 2, .1, .8, MotionOf::speed, 3}, HarmonicMotion{.2, .7, 1.3, .4}};
  for (const Interpolation i : all)
    for (const MotionOf of : {MotionOf::position, MotionOf::speed}) motions.push_back(table(i, of));
  const double e = 1e-6;
  for (const Motion& motion : motions) {
    const MotionFunction f(motion);
    for (const double t : {-.2, .013, .21, .47, .53, .74, .93, 1.5}) {
      const CoordinateMotion a = f.at(t - e), b = f.at(t), c = f.at(t + e);
      EXPECT_NEAR(b.rate, (c.value - a.value) / (2 * e), 2e-7) << motion.index() << " at " << t;
      EXPECT_NEAR(b.acceleration, (c.rate - a.rate) / (2 * e), 3e-5) << motion.index() << " at " << t;
    }
  }
}

TEST(MotionFunction, RampIsAtRestOutside) {
  const MotionFunction f(RampMotion{1, 3, .5, 2});
  EXPECT_EQ(f.at(.5).value, 1);
  EXPECT_EQ(f.at(2.5).value, 3);
  EXPECT_NEAR(f.at(1.5).value, 2, 1e-15);
  for (const double t : {0.0, .5, 2.5, 9.0}) {
    EXPECT_EQ(f.at(t).rate, 0);
    EXPECT_EQ(f.at(t).acceleration, 0);
  }
}

// Speed 1 until 0.5 s, a ramp of 2 s whose mean is 2, then 3.
TEST(MotionFunction, RampOfSpeedGoesOnAtSpeed) {
  const MotionFunction f(RampMotion{1, 3, .5, 2, MotionOf::speed, -4});
  EXPECT_NEAR(f.at(0).value, -4, 1e-15);
  EXPECT_NEAR(f.at(.5).value, -3.5, 1e-15);
  EXPECT_NEAR(f.at(2.5).value, .5, 1e-14);
  EXPECT_NEAR(f.at(12.5).value, 30.5, 1e-13);
  EXPECT_EQ(f.at(12.5).rate, 3);
  EXPECT_EQ(f.at(12.5).acceleration, 0);
  EXPECT_EQ(f.breaks(), (std::vector<double>{.5, 2.5}));
}

// The integral by Simpson's rule over parts between the knots; ends at speed.
TEST(MotionFunction, PositionIsTheIntegralOfTheSpeeds) {
  for (const Interpolation i : all) {
    const MotionFunction f(table(i, MotionOf::speed));
    const PiecewisePolynomial speed = table_curve(table(i, MotionOf::speed), FunctionOf::coordinate);
    EXPECT_NEAR(f.at(0).value, .7, 1e-15);
    double sum = .7;
    constexpr int n = 4000;
    for (int k = 0; k < n; ++k) {
      const double a = 1.2 * k / n, h = 1.2 / n;
      sum += h / 6 * (speed.at(a).value + 4 * speed.at(a + h / 2).value + speed.at(a + h).value);
    }
    EXPECT_NEAR(f.at(1.2).value, sum, 1e-8);
    EXPECT_NEAR(f.at(5).rate, .3, 1e-12);
    EXPECT_EQ(f.at(5).acceleration, 0);
    EXPECT_EQ(jumps_of_acceleration(f),
              i == Interpolation::spline ? 2 : 0);  // natural splines end with a slope
    EXPECT_TRUE(f.rate_jumps().empty());
  }
}

// Only splines jump; the others begin and end at rest.
TEST(MotionFunction, TablesOfPositionsHaveAContinuousAccelerationButForSplines) {
  for (const Interpolation i : all) {
    const MotionFunction f(table(i));
    EXPECT_EQ(jumps_of_acceleration(f), 0);
    EXPECT_EQ(f.rate_jumps().size(), i == Interpolation::spline ? 2u : 0u);
    EXPECT_EQ(f.at(-1).value, 0);
    EXPECT_NEAR(f.at(2).value, .3, 1e-14);
    EXPECT_EQ(f.at(2).rate, 0);
  }
}

TEST(MotionFunction, SplineThatEndsAtSpeedJumps) {
  const MotionFunction f(TableMotion{{0, .25, .5}, {0, .25, .5}, Interpolation::spline});
  EXPECT_NEAR(f.at(.3).rate, 1, 1e-14);
  const Jumps jumps = f.rate_jumps();
  ASSERT_EQ(jumps.size(), 2u);
  EXPECT_EQ(jumps[1].time, .5);
  EXPECT_NEAR(jumps[1].before, 1, 1e-14);
  EXPECT_EQ(jumps[1].after, 0);
  EXPECT_NEAR(f.at(.5, .4).rate, 1, 1e-14);
  EXPECT_EQ(f.at(.5, .5).rate, 0);
}

// A table of forces is neither smoothed nor quintic.
TEST(MotionFunction, SizesOfForces) {
  const auto size = [](Interpolation i) {
    return MotionFunction(TableMotion{times, values, i}, FunctionOf::force);
  };
  EXPECT_NEAR(size(Interpolation::linear).at(.35).value, 0, 1e-15);
  EXPECT_EQ(size(Interpolation::linear).breaks(), times);
  EXPECT_EQ(size(Interpolation::step).at(.49).value, 1);
  EXPECT_EQ(size(Interpolation::step).at(.5).value, -1);
  EXPECT_EQ(size(Interpolation::step).at(.5, .2).value, 1);
  EXPECT_EQ(size(Interpolation::step).breaks(), (std::vector<double>{.2, .5, .6, 1}));
  // Only the ends of steep intervals are breaks, although the function is smooth there.
  const Motion dense =
      TableMotion{{0, .1, .2, .3, .4, .5, 1}, {0, 0, .05, .1, 3, 3, 3}, Interpolation::monotone};
  EXPECT_EQ(MotionFunction(dense, FunctionOf::force).breaks(), (std::vector<double>{.3, .4}));
  // From one extreme to the next a cubic is symmetric.
  EXPECT_NEAR(size(Interpolation::monotone).at(.35).value, 0, 1e-15);
  EXPECT_NEAR(size(Interpolation::monotone).at(.275).value, 1 - 2 * (3 * .0625 - 2 * .015625), 1e-14);
}

// Steps of 10 ms, and changes within 1 ms: parts of the same impulse and first moment, a coordinate with its
// values and rates at their ends, and a signal with its values.
TEST(MotionFunction, IsDividedWhereItIsFasterThanTheSteps) {
  const TableMotion pulse{{0, .1, .1004, .101, .3}, {0, 0, 5, 0, 0}, Interpolation::monotone};
  MotionFunction force(pulse, FunctionOf::force), exact = force, signal = force;
  force.resolve(.01, MotionFunction::Steps::trapezoidal, MotionFunction::Use::force, HUGE_VAL);
  signal.resolve(.01, MotionFunction::Steps::trapezoidal, MotionFunction::Use::signal, HUGE_VAL);
  double impulse = 0, moment = 0, difference = 0;
  constexpr int parts = 200000;
  for (int k = 0; k < parts; ++k) {
    const double t = .0999 + .0012 * (k + .5) / parts, dt = .0012 / parts;
    const double d = force.at(t).value - exact.at(t).value;
    impulse += d * dt, moment += d * dt * (t - .1), difference = std::max(difference, std::abs(d));
    EXPECT_NEAR(signal.at(t).value, exact.at(t).value, 1e-12);
  }
  EXPECT_NEAR(impulse, 0, 1e-9);
  EXPECT_NEAR(moment, 0, 1e-12);
  EXPECT_GT(difference, 1e-3);
  EXPECT_GE(force.breaks().size(), 64u);
  MotionFunction ramp(RampMotion{0, .2, .1, .001}), exact_ramp = ramp;
  ramp.resolve(.01, MotionFunction::Steps::trapezoidal, MotionFunction::Use::coordinate, 1);
  ASSERT_GE(ramp.breaks().size(), 65u);
  for (const double t : ramp.breaks()) {
    EXPECT_NEAR(ramp.at(t).value, exact_ramp.at(t).value, 1e-13);
    EXPECT_NEAR(ramp.at(t).rate, exact_ramp.at(t).rate, 1e-10);
  }
  MotionFunction slow(RampMotion{0, .2, .1, .7});
  const auto before = slow.breaks();
  slow.resolve(.01, MotionFunction::Steps::trapezoidal, MotionFunction::Use::coordinate, 1);
  EXPECT_EQ(slow.breaks(), before);
}

TEST(MotionFunction, RefusesATableOfOnePoint) {
  EXPECT_THROW(MotionFunction(TableMotion{{0}, {1}}), Error);
}

}  // namespace
}  // namespace tandem::scene
