// Functions through points: no overshoot, smoothness, and closed forms.
#include "common/math/interpolation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace tandem {
namespace {

struct Table {
  Points x, y;
};

// Flat parts, steps, very short and very long intervals, values of all sizes.
Table random_table(std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1);
  Table t;
  const int n = 2 + static_cast<int>(random() % 9);
  double x = share(random), y = 2 * share(random) - 1;
  const double size = std::pow(10, 8 * share(random) - 4);
  for (int i = 0; i < n; ++i) {
    t.x.push_back(x), t.y.push_back(size * y);
    x += std::pow(10, -3 + 4 * share(random));
    if (share(random) > 0.25) y += (share(random) - 0.5) * std::pow(10, -3 + 4 * share(random));
  }
  return t;
}

double range(const Points& y) {
  return *std::max_element(y.begin(), y.end()) - *std::min_element(y.begin(), y.end());
}

template <class F>
void for_random_tables(F&& f) {
  std::mt19937 random(7);
  for (int i = 0; i < 2000; ++i) f(random_table(random));
}

// Between any two points, shifted by `late`, the curve is monotone.
void expect_monotone(const PiecewisePolynomial& curve, const Table& t, double late = 0) {
  const double slack = 1e-12 * (std::abs(t.y.front()) + range(t.y));
  for (std::size_t i = 0; i + 1 < t.x.size(); ++i) {
    const double rise = t.y[i + 1] >= t.y[i] ? 1 : -1;
    double last = t.y[i];
    for (int s = 1; s <= 100; ++s) {
      const double x = t.x[i] + (t.x[i + 1] - t.x[i]) * s / 100, value = curve.at(x + late).value;
      ASSERT_GE(rise * (value - last), -slack) << "at " << x;
      ASSERT_LE(rise * (value - t.y[i + 1]), slack) << "at " << x;
      last = value;
    }
  }
}

// Jumps of value and derivatives at all knots, relative to the largest possible value in the neighbourhood.
double largest_jump(const PiecewisePolynomial& curve, int order) {
  double jump = 0;
  const auto& x = curve.knots();
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto a = curve.before(k), b = curve.after(k);
    const double h = std::min(k > 0 ? x[k] - x[k - 1] : 1, k + 1 < x.size() ? x[k + 1] - x[k] : 1);
    double range = 1e-300;
    for (std::size_t i = std::max<std::size_t>(k, 1) - 1; i < std::min(k + 2, x.size()); ++i)
      range = std::max(range, std::abs(curve.after(i).value));
    jump = std::max(jump, std::abs(b.value - a.value) / range);
    if (order > 0) jump = std::max(jump, std::abs(b.first - a.first) * h / range);
    if (order > 1) jump = std::max(jump, std::abs(b.second - a.second) * h * h / range);
  }
  return jump;
}

TEST(Interpolation, MonotoneCubicStaysBetweenItsPoints) {
  for_random_tables([](const Table& t) {
    for (const Ends ends : {Ends::flat, Ends::held, Ends::straight}) {
      const PiecewisePolynomial curve = monotone_cubic(t.x, t.y, ends);
      expect_monotone(curve, t);
      EXPECT_LT(largest_jump(curve, ends == Ends::held ? 0 : 1), 1e-9);
    }
  });
}

TEST(Interpolation, MonotoneQuinticStaysBetweenItsPointsAndItsAccelerationIsContinuous) {
  for_random_tables([](const Table& t) {
    PiecewisePolynomial curve = monotone_quintic(t.x, t.y);
    expect_monotone(curve, t);
    EXPECT_LT(largest_jump(curve, 2), 1e-9);
    curve.find_breaks(2);
    EXPECT_TRUE(curve.breaks().empty());
    for (const double x : {t.x.front(), t.x.back()}) {
      EXPECT_NEAR(curve.at(x).first, 0, 1e-9 * range(t.y) / (t.x.back() - t.x[t.x.size() - 2]));
      EXPECT_EQ(curve.at(x + (x == t.x.front() ? -1 : 1)).first, 0);
    }
  });
}

TEST(Interpolation, SmoothedTablesStayBetweenTheirPointsAndTheirAccelerationIsContinuous) {
  for_random_tables([](const Table& t) {
    double width = HUGE_VAL;
    for (std::size_t i = 1; i < t.x.size(); ++i) width = std::min(width, t.x[i] - t.x[i - 1]);
    for (const double share : {0.3, 1.0}) {
      PiecewisePolynomial line = smoothed_linear_interpolation(t.x, t.y, share * width);
      // The mean of a line over `width` is the line delayed by half of `width`; an extreme of the
      // points is rounded.
      const double least = *std::min_element(t.y.begin(), t.y.end()),
                   most = *std::max_element(t.y.begin(), t.y.end());
      for (double x = t.x.front(); x < t.x.back() + width; x += 0.01 * (t.x.back() - t.x.front())) {
        ASSERT_LE(line.at(x).value, most + 1e-12 * range(t.y) + 1e-12 * std::abs(most));
        ASSERT_GE(line.at(x).value, least - 1e-12 * range(t.y) - 1e-12 * std::abs(least));
      }
      PiecewisePolynomial step = smoothed_step_interpolation(t.x, t.y, share * width);
      for (PiecewisePolynomial* curve : {&line, &step}) {
        curve->find_breaks(2);
        EXPECT_TRUE(curve->breaks().empty());
        EXPECT_NEAR(curve->at(t.x.back() + width).value, t.y.back(), 1e-9 * range(t.y));
        EXPECT_NEAR(curve->at(t.x.front()).value, t.y.front(), 1e-9 * range(t.y));
        EXPECT_NEAR(curve->at(t.x.front()).first, 0, 1e-9 * range(t.y) / width);
      }
      for (std::size_t i = 0; i + 1 < t.x.size(); ++i)
        EXPECT_NEAR(step.at(t.x[i + 1]).value, t.y[i], 1e-9 * range(t.y));
    }
  });
}

// Weighted means, by quadrature.
TEST(Interpolation, SmoothedTablesAreWeightedMeans) {
  const Points x{.2, 1, 1.5, 3}, y{1, -1, 2, 1.5};
  const double width = .4;
  const auto mean = [&](const PiecewisePolynomial& curve, double at) {
    double sum = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double s = (i + .5) / n;
      sum += 30 * s * s * (1 - s) * (1 - s) * curve.at(at - s * width).value / n;
    }
    return sum;
  };
  for (const double at : {.1, .3, .5, .9, 1.1, 1.35, 1.45, 1.7, 2.5, 3.2, 3.5}) {
    EXPECT_NEAR(smoothed_linear_interpolation(x, y, width).at(at).value, mean(linear_interpolation(x, y), at),
                1e-7);
    EXPECT_NEAR(smoothed_step_interpolation(x, y, width).at(at).value, mean(step_interpolation(x, y), at),
                1e-3);
  }
}

TEST(Interpolation, MonotoneQuinticThroughTwoPointsIsTheRamp) {
  const PiecewisePolynomial ramp = monotone_quintic({1, 3}, {5, 9});
  for (const double s : {.1, .35, .5, .8}) {
    EXPECT_NEAR(ramp.at(1 + 2 * s).value, 5 + 4 * s * s * s * (10 + s * (6 * s - 15)), 1e-14);
    EXPECT_NEAR(ramp.at(1 + 2 * s).first, 4 / 2. * 30 * s * s * (1 - s) * (1 - s), 1e-13);
    EXPECT_NEAR(ramp.at(1 + 2 * s).second, 4 / 4. * 60 * s * (1 - s) * (1 - 2 * s), 1e-13);
  }
}

// At every inner point a parabola has its own slope and second derivative, as far as the bounds allow.
TEST(Interpolation, MonotoneQuinticFollowsSmoothData) {
  double last = 0;
  for (const int n : {16, 32, 64}) {
    Points x, y;
    for (int i = 0; i <= n; ++i) x.push_back(double(i) / n), y.push_back(std::exp(x.back()));
    const PiecewisePolynomial curve = monotone_quintic(x, y);
    double error = 0;
    for (double at = .25; at < .75; at += .001)
      error = std::max(error, std::abs(curve.at(at).value - std::exp(at)));
    if (last > 0) {
      EXPECT_GT(std::log2(last / error), 2.8) << error;
    }
    last = error;
  }
  EXPECT_LT(last, 1e-6);
}

TEST(Interpolation, NaturalSplineIsSmoothAndOvershoots) {
  const Points x{0, .5, .51, 1}, y{0, 0, 1, 1};
  const PiecewisePolynomial spline = natural_spline(x, y);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(spline.at(x[i]).value, y[i], 1e-14);
  const Overshoot over = largest_overshoot(spline, x, y);
  EXPECT_NEAR(over.value, -8.5, 1.1);
  EXPECT_GT(over.size, 8);
  EXPECT_EQ(largest_overshoot(monotone_quintic(x, y), x, y).size, 0);
}

TEST(Interpolation, OvershootIsNotWhatSmoothDataAskFor) {
  for (const int n : {8, 13, 20, 50})
    for (const double phase : {0., .1, .5}) {
      Points x, y;
      for (int i = 0; i <= 3 * n; ++i)
        x.push_back(double(i) / n), y.push_back(std::sin(2 * std::numbers::pi * x.back() + phase));
      EXPECT_EQ(largest_overshoot(natural_spline(x, y), x, y).size, 0) << n << " " << phase;
    }
  const Points x{0, 1, 2, 3, 4}, bump{0, 0, .04, 0, 0};
  const Overshoot over = largest_overshoot(natural_spline(x, bump), x, bump);
  EXPECT_GT(over.size, .003);
  EXPECT_NE(over.interval, 1u);
}

TEST(PiecewisePolynomial, BreaksAreWhereADerivativeJumps) {
  const Points x{0, 1, 2, 3}, y{0, 1, 2, 0};
  PiecewisePolynomial line = linear_interpolation(x, y);
  line.find_breaks(0);
  EXPECT_TRUE(line.breaks().empty());
  line.find_breaks(1);
  EXPECT_EQ(line.breaks(), (Points{0, 2, 3}));  // it continues straight at 1
  PiecewisePolynomial step = step_interpolation(x, y);
  step.find_breaks(0);
  EXPECT_EQ(step.breaks(), (Points{1, 2, 3}));
}

// Where a break separates two pieces, the piece of `side` is used.
TEST(PiecewisePolynomial, DoesNotStepOverABreak) {
  PiecewisePolynomial step = step_interpolation({0, 1, 2}, {5, 6, 7});
  EXPECT_EQ(step.at(1).value, 6);
  step.find_breaks(1);
  EXPECT_EQ(step.at(1, .5).value, 5);
  EXPECT_EQ(step.at(1.3, .5).value, 5);
  EXPECT_EQ(step.at(1, 1).value, 6);
  EXPECT_EQ(step.at(1, 1 - 1e-13).value, 6);
  EXPECT_EQ(step.at(.9, 1).value, 6);
  PiecewisePolynomial ramp = monotone_quintic({0, 1, 3}, {0, 2, 2});
  ramp.find_breaks(2, .5);
  EXPECT_EQ(ramp.breaks(), (Points{0, 1}));
  const PiecewisePolynomial::Value v = ramp.at(.75, 1.2);  // the piece that begins at 1, by its tangent
  EXPECT_EQ(v.value, 2);
  EXPECT_EQ(v.first, 0);
  EXPECT_EQ(step.at(2, 1.5).value, 6);
  EXPECT_EQ(step.at(5, 2).value, 7);
}

TEST(PiecewisePolynomial, AntiderivativeIsContinuousAndHasTheFunctionForItsDerivative) {
  const Points x{-1, 0, .5, 2}, y{1, 3, -2, 0};
  for (const PiecewisePolynomial& curve :
       {monotone_cubic(x, y, Ends::straight), monotone_quintic(x, y), linear_interpolation(x, y),
        smoothed_linear_interpolation(x, y, .5)}) {
    const PiecewisePolynomial integral = curve.antiderivative();
    EXPECT_NEAR(integral.at(-1).value, 0, 1e-15);
    EXPECT_LT(largest_jump(integral, 1), 1e-13);
    for (const double at : {-3., -.7, .2, 1.3, 4.})
      EXPECT_NEAR(integral.at(at).first, curve.at(at).value, 1e-13);
  }
}

}  // namespace
}  // namespace tandem
