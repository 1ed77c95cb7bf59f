#include "particles/base/exact_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace tandem::particles {
namespace {

TEST(ExactSum, IsThatOfTheFixedPointNumbers) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> mantissa(-1, 1), exponent(-50, 0);
  for (const double bound : {1e-6, 3.0, 7e11}) {
    const Quantum sum = Quantum::for_range(1000 * bound);
    const auto scale = AddendScale<float>::of(sum, bound);
    EXPECT_GE(static_cast<double>(scale.bound), bound);
    Quantum of_addends = sum;
    of_addends.size = std::ldexp(sum.size, scale.shift);
    of_addends.inverse = 1 / of_addends.size;
    EXPECT_LE(of_addends.size, bound * 0x1p-43);
    for (int trial = 0; trial < 100; ++trial) {
      std::vector<float> addends(trial < 50 ? 37 : 511);
      for (float& x : addends) x = static_cast<float>(bound * mantissa(random) * std::exp2(exponent(random)));
      std::int64_t expected = 0;
      ExactSum<float> found, backwards;
      for (const float x : addends) {
        expected += to_fixed(static_cast<double>(x), of_addends) << scale.shift;
        found.add(x, scale);
        backwards.add(-x, scale);
      }
      const auto count = static_cast<std::uint32_t>(addends.size());
      ASSERT_EQ(found.value(scale, count), expected);
      ASSERT_EQ(backwards.value(scale, count), -expected);
    }
  }
}

TEST(ExactSum, OfASmallBoundHasTheQuantumOfTheSum) {
  const Quantum sum = Quantum::for_range(1);
  const auto scale = AddendScale<float>::of(sum, 1e-15);
  EXPECT_EQ(scale.shift, 0);
}

}  // namespace
}  // namespace tandem::particles
