// Square roots and quotients that are correctly rounded on every back end and free of branches on a GPU. The
// built-in ones of a GPU call a subroutine for operands near the ends of the range, and the branches around
// these calls prevent the compiler from overlapping them with other work. The caller ensures that operands
// are within the stated bounds. The steps that make an approximation exact are those of P. W. Markstein, IBM
// Journal of Research and Development 34 (1990) 111.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "common/host_device.hpp"

namespace tandem::particles {

// Square root of x >= 2^-100.
TANDEM_HD inline double root(double x) {
  return std::sqrt(x);
}
TANDEM_HD inline float root(float x) {
#if defined(__CUDA_ARCH__)
  // The instructions that the compiler emits for operands from 2^-101 on.
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
  // The remainders are exact, so that the second one determines the rounding of the quotient.
  const float inverse = reciprocal(b), guess = __fmul_rn(a, inverse);
  const float better = __fmaf_rn(inverse, __fmaf_rn(-b, guess, a), guess);
  return __fmaf_rn(inverse, __fmaf_rn(-b, better, a), better);
#else
  return a / b;
#endif
}

// The double nearest to x that a float can represent, for |x| in the range of a float. It rounds the bits of
// x: a conversion to float and back costs a GPU more, and GCC 12 wrongly returns x itself where it vectorises
// that conversion.
TANDEM_HD inline double nearest_single(double x) {
  constexpr std::uint64_t beyond_float = (std::uint64_t{1} << 29) - 1;
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(x) + (std::uint64_t{1} << 28)) & ~beyond_float);
}

}  // namespace tandem::particles
