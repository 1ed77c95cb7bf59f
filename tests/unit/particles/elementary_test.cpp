// Elementary functions against those of the host.
#include "particles/base/elementary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

namespace tandem::particles::test {
namespace elementary_test {

TEST(Elementary, AreThoseOfTheHost) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-1, 1), exponent(-30, 30);
  double angle = 0, logarithms = 0, hyperbolic = 0;
  for (int k = 0; k < 200'000; ++k) {
    const double x = any(random) * std::pow(10, exponent(random)),
                 y = any(random) * std::pow(10, exponent(random));
    const auto share = [](double value, double expected) {
      return expected == 0 ? std::fabs(value) : std::fabs(value / expected - 1);
    };
    const double u = any(random), v = any(random);
    angle =
        std::max({angle, share(angle_of(y, x), std::atan2(y, x)), share(angle_of(u, v), std::atan2(u, v))});
    logarithms = std::max(logarithms, std::fabs(logarithm(std::fabs(x)) - std::log(std::fabs(x))) /
                                          std::max(1.0, std::fabs(std::log(std::fabs(x)))));
    hyperbolic =
        std::max({hyperbolic, share(inverse_sinh(x), std::asinh(x)), share(inverse_sinh(u), std::asinh(u))});
  }
  std::printf("  largest errors: angle %.2g, logarithm %.2g, inverse sinh %.2g\n", angle, logarithms,
              hyperbolic);
  EXPECT_LT(angle, 8e-16);
  EXPECT_LT(logarithms, 8e-16);
  EXPECT_LT(hyperbolic, 8e-16);
}

TEST(Elementary, AnglesOfZerosHaveTheirSigns) {
  for (const double y : {0.0, -0.0, 1.0, -1.0})
    for (const double x : {0.0, -0.0, 1.0, -1.0}) {
      const double angle = angle_of(y, x), expected = std::atan2(y, x);
      EXPECT_DOUBLE_EQ(angle, expected) << y << ' ' << x;
      EXPECT_EQ(std::signbit(angle), std::signbit(expected)) << y << ' ' << x;
    }
  EXPECT_EQ(inverse_sinh(0), 0);
  EXPECT_DOUBLE_EQ(inverse_sinh(1e200), std::asinh(1e200));
}

}  // namespace elementary_test
}  // namespace tandem::particles::test
