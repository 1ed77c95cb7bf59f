// Exact sums in any order: addends are rounded once to a multiple of a quantum and added as 64-bit integers.
// Body loads therefore have the same bits for every number of threads, block size and back end.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>

#include "common/math/vec3.hpp"

namespace tandem::particles {

// Quantum of a sum: a power of two, so that scaling is exact.
struct Quantum {
  double size = 1;     // [unit of the addend]
  double inverse = 1;  // 1/size

  // The smallest power of two that lets |sum| reach `largest` with two bits to spare.
  static Quantum for_range(double largest) {
    int exponent = 0;
    std::frexp(largest, &exponent);
    return {std::ldexp(1.0, exponent - 61), std::ldexp(1.0, 61 - exponent)};
  }
  // A quantum for sums of up to 2^28 remainders of the rounding to this one.
  TANDEM_HD Quantum of_remainders() const {
    constexpr double parts = 17179869184;  // 2^34
    return {size / parts, inverse * parts};
  }
};

TANDEM_HD inline std::int64_t to_fixed(double value, Quantum q) {
#if defined(__CUDA_ARCH__)
  return __double2ll_rn(value * q.inverse);
#else
  return std::llrint(value * q.inverse);
#endif
}

TANDEM_HD inline double from_fixed(std::int64_t value, Quantum q) {
  return static_cast<double>(value) * q.size;
}

// Adds to a sum that several threads share.
TANDEM_HD inline void add_shared(std::int64_t* sum, std::int64_t amount) {
#if defined(__CUDA_ARCH__)
  atomicAdd(reinterpret_cast<unsigned long long*>(sum), static_cast<unsigned long long>(amount));
#else
  std::atomic_ref<std::int64_t>(*sum).fetch_add(amount, std::memory_order_relaxed);
#endif
}

// `value` rounded to the quantum. Both sides of a contact must use this value, so that their balance closes
// exactly.
TANDEM_HD inline Vec3d rounded(Vec3d value, Quantum q) {
  return {from_fixed(to_fixed(value.x, q), q), from_fixed(to_fixed(value.y, q), q),
          from_fixed(to_fixed(value.z, q), q)};
}

}  // namespace tandem::particles
