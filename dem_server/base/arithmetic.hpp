// Square roots and quotients, correctly rounded on every back end and, on a GPU, without branches: its own
// ones call a subroutine for operands near the ends of the range, and the branches around these calls keep a
// compiler from doing other things meanwhile. Whoever calls sees to it that operands are within the bounds.
// The steps that make an approximation exact are Markstein's, 1990, IBM J. Res. Dev. 34:111.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "common/host_device.hpp"

namespace tandem::dem {

// The square root of x from 2^-100 on.
TANDEM_HD inline double root(double x) {
  return std::sqrt(x);
}
TANDEM_HD inline float root(float x) {
#if defined(__CUDA_ARCH__)
  // What the compiler emits for operands from 2^-101 on.
  float inverse;
  asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(x));
  const float guess = __fmul_rn(x, inverse), half = __fmul_rn(0.5F, inverse);
  return __fmaf_rn(__fmaf_rn(-guess, guess, x), half, guess);
#else
  return std::sqrt(x);
#endif
}

// 1 / x for x from 2^-126 to 2^126.
TANDEM_HD inline double reciprocal(double x) {
  return 1 / x;
}
TANDEM_HD inline float reciprocal(float x) {
#if defined(__CUDA_ARCH__)
  float guess;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(guess) : "f"(x));
  return __fmaf_rn(guess, __fmaf_rn(-x, guess, 1.0F), guess);
#else
  return 1 / x;
#endif
}

// a / b for a that is 0 or from 2^-100 on, b from 2^-100 to 2^126, and a quotient from 2^-100 to 2^100.
TANDEM_HD inline double quotient(double a, double b) {
  return a / b;
}
TANDEM_HD inline float quotient(float a, float b) {
#if defined(__CUDA_ARCH__)
  // The rests are exact, so that the second one decides how the quotient is rounded.
  const float inverse = reciprocal(b), guess = __fmul_rn(a, inverse);
  const float better = __fmaf_rn(inverse, __fmaf_rn(-b, guess, a), guess);
  return __fmaf_rn(inverse, __fmaf_rn(-b, better, a), better);
#else
  return a / b;
#endif
}

// The double nearest to x that a float can hold, but for magnitudes beyond a float's: what others are told of
// x. Bits instead of a conversion there and back, which costs a GPU more, and for which GCC 12 puts x itself
// where it does several at once.
TANDEM_HD inline double nearest_single(double x) {
  constexpr std::uint64_t beyond_float = (std::uint64_t{1} << 29) - 1;
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(x) + (std::uint64_t{1} << 28)) & ~beyond_float);
}

}  // namespace tandem::dem
