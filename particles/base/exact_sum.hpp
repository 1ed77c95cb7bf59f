// Exact sums, in any order, of many numbers in single precision. The result is that of to_fixed() for each of
// them, without its conversions, which cost a GPU more than the numbers themselves.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "common/host_device.hpp"
#include "particles/base/fixed_point.hpp"

namespace tandem::particles {

inline constexpr std::uint32_t most_addends = 511;  // of one sum

// How addends of a sum in quanta of `sum` are rounded. They are below a bound.
template <class Real>
struct AddendScale;

template <>
struct AddendScale<double> {
  Quantum quantum;
  double bound = 0;

  static AddendScale of(Quantum sum, double bound) { return {sum, bound}; }
};

// Adding 1.5 * 2^23 u to a number below 2^22 u rounds it to a multiple of u, which the last 23 bits of the
// result hold; what is left of the number is exact. So two additions find a number as a multiple of 2^22
// quanta and a multiple of one.
template <>
struct AddendScale<float> {
  float coarse = 0, fine = 0;  // 1.5 * 2^23 of these two units
  int shift = 0;               // a quantum of the addends has 2^shift quanta of the sum
  float bound = 0;

  // The finest quantum for addends up to `bound`, at least that of the sum.
  static AddendScale of(Quantum sum, double bound) {
    int exponent = 0, of_sum = 0;
    std::frexp(bound, &exponent);
    std::frexp(sum.size, &of_sum);
    exponent = std::max(exponent - 44, of_sum - 1);
    return {std::ldexp(1.5F, exponent + 45), std::ldexp(1.5F, exponent + 23), exponent - of_sum + 1,
            std::ldexp(1.0F, exponent + 44)};
  }
};

template <class Real>
class ExactSum;

template <>
class ExactSum<double> {
 public:
  TANDEM_HD void add(double x, const AddendScale<double>& scale) { sum_ += to_fixed(x, scale.quantum); }
  TANDEM_HD std::int64_t value(const AddendScale<double>&, std::uint32_t) const { return sum_; }

 private:
  std::int64_t sum_ = 0;
};

template <>
class ExactSum<float> {
 public:
  ExactSum() = default;
  // Of sums of bit patterns, see add().
  TANDEM_HD ExactSum(std::uint32_t high, std::uint32_t low) : high_(high), low_(low) {}
  TANDEM_HD void add(float x, const AddendScale<float>& scale) {
    const float high = x + scale.coarse, rest = x - (high - scale.coarse);
    high_ += std::bit_cast<std::uint32_t>(high);
    low_ += std::bit_cast<std::uint32_t>(rest + scale.fine);
  }
  // In quanta of the sum; of this many addends.
  TANDEM_HD std::int64_t value(const AddendScale<float>& scale, std::uint32_t addends) const {
    const auto part = [addends](std::uint32_t sum, float zero) {
      return std::int64_t{static_cast<std::int32_t>(sum - addends * std::bit_cast<std::uint32_t>(zero))};
    };
    return (part(high_, scale.coarse) * (1 << 22) + part(low_, scale.fine)) *
           (std::int64_t{1} << scale.shift);
  }

 private:
  std::uint32_t high_ = 0, low_ = 0;  // sums of bit patterns, modulo 2^32
};

}  // namespace tandem::particles
