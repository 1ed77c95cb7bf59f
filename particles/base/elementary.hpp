// Elementary functions from + - * / and square roots, so that every back end gets the same bits: the
// libraries of a host and of a device round them differently. Errors are below 8e-16 of the value, or of 1
// where that is stated.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "common/host_device.hpp"

namespace tandem::particles {

namespace detail {

// Sum of sign^n x^(2 n + 1) / (2 n + 1), for |x| <= 0.2: the arc tangent (sign -1) and the inverse hyperbolic
// tangent (sign 1).
template <int sign>
TANDEM_HD inline double odd_series(double x) {
  constexpr double factor[] = {1. / 3,  1. / 5,  1. / 7,  1. / 9,  1. / 11, 1. / 13,
                               1. / 15, 1. / 17, 1. / 19, 1. / 21, 1. / 23, 1. / 25};
  const double x2 = sign * (x * x);
  double sum = 0;
  for (int n = 11; n >= 0; --n) sum = factor[n] + x2 * sum;
  return x + x * (x2 * sum);
}

}  // namespace detail

// The angle of the vector (x, y) [rad], as std::atan2 also for zeros with a sign.
TANDEM_HD inline double angle_of(double y, double x) {
  const double across = std::fabs(y), along = std::fabs(x);
  const bool steep = across > along;
  const double large = steep ? across : along, small = steep ? along : across;
  double angle = 0;  // from the nearer axis
  if (small > 0) {
    // Half the angle, and half of that, until the series converges fast.
    double t = small / large;
    t = t / (1 + std::sqrt(1 + t * t));
    t = t / (1 + std::sqrt(1 + t * t));
    angle = 4 * detail::odd_series<-1>(t);
  }
  if (steep) angle = std::numbers::pi / 2 - angle;
  if (std::signbit(x)) angle = std::numbers::pi - angle;
  return std::copysign(angle, y);
}

// ln x of a positive, normal number; the error is below 8e-16 of the larger of |ln x| and 1.
TANDEM_HD inline double logarithm(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  auto exponent = static_cast<std::int64_t>(bits >> 52) - 1023;
  double m = std::bit_cast<double>((bits & ((std::uint64_t{1} << 52) - 1)) | std::uint64_t{1023} << 52);
  if (m > std::numbers::sqrt2) {
    m *= 0.5;
    ++exponent;
  }
  return static_cast<double>(exponent) * std::numbers::ln2 + 2 * detail::odd_series<1>((m - 1) / (m + 1));
}

TANDEM_HD inline double inverse_sinh(double x) {
  constexpr double series_below = 0.35, square_is_all = 1e8;
  const double a = std::fabs(x);
  double value = 0;
  if (a < series_below) {
    value = 2 * detail::odd_series<1>(a / (1 + std::sqrt(1 + a * a)));
  } else if (a < square_is_all) {
    value = logarithm(a + std::sqrt(a * a + 1));
  } else {
    value = logarithm(a) + std::numbers::ln2;
  }
  return std::copysign(value, x);
}

}  // namespace tandem::particles
