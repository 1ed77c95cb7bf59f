// The device's square roots and quotients for contacts must be rounded as IEEE 754 requires, like those of
// the host. The reference is the compiler's own functions, which cover the whole range.
#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include <cstdint>

#include "particles/base/arithmetic.hpp"

namespace tandem::test {
namespace {

// The result for one set of operands.
enum Verdict : unsigned { left_out, right, wrong };
struct Counts {
  unsigned long long of[3]{};
};

// Counts the verdicts on all 2^32 words.
template <class Judge>
__global__ void count_kernel(Judge judge, Counts* counts) {
  unsigned long long mine[3]{};
  for (std::uint64_t bits = blockIdx.x * blockDim.x + threadIdx.x; bits < std::uint64_t{1} << 32;
       bits += gridDim.x * blockDim.x)
    ++mine[judge(static_cast<std::uint32_t>(bits))];
  for (int v = 0; v < 3; ++v) atomicAdd(counts->of + v, mine[v]);
}

__device__ Verdict same_bits(float a, float b) {
  return __float_as_uint(a) == __float_as_uint(b) ? right : wrong;
}

template <class Judge>
void expect_all_right(Judge judge, unsigned long long at_least) {
  Counts* on_device = nullptr;
  Counts found;
  ASSERT_EQ(cudaMalloc(&on_device, sizeof(found)), cudaSuccess);
  ASSERT_EQ(cudaMemset(on_device, 0, sizeof(found)), cudaSuccess);
  count_kernel<<<1024, 256>>>(judge, on_device);
  ASSERT_EQ(cudaGetLastError(), cudaSuccess);
  ASSERT_EQ(cudaMemcpy(&found, on_device, sizeof(found), cudaMemcpyDeviceToHost), cudaSuccess);
  cudaFree(on_device);
  EXPECT_EQ(found.of[wrong], 0u);
  EXPECT_GE(found.of[right], at_least);
}

struct Root {
  __device__ Verdict operator()(std::uint32_t bits) const {
    const float x = __uint_as_float(bits);
    return x >= 0x1p-100F && x < INFINITY ? same_bits(particles::root(x), __fsqrt_rn(x)) : left_out;
  }
};
TEST(Arithmetic, RootsAreRoundedCorrectlyForEveryOperand) {
  expect_all_right(Root{}, 228ull << 23);
}

struct Reciprocal {
  __device__ Verdict operator()(std::uint32_t bits) const {
    const float x = __uint_as_float(bits), size = fabsf(x);
    return size >= 0x1p-126F && size < 0x1p126F ? same_bits(particles::reciprocal(x), __frcp_rn(x))
                                                : left_out;
  }
};
TEST(Arithmetic, ReciprocalsAreRoundedCorrectlyForEveryOperand) {
  expect_all_right(Reciprocal{}, 504ull << 23);
}

// Pseudorandom operands (the finaliser of MurmurHash3) over all admitted exponents.
struct Quotient {
  std::uint32_t seed;

  __device__ static std::uint32_t mixed(std::uint32_t h) {
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
  }
  __device__ static float operand(std::uint32_t mantissa, std::uint32_t exponent) {
    return __uint_as_float((mantissa & 0x007fffffu) |
                           ((127u - 100u + exponent % 226u) << 23));  // 2^-100 to 2^126
  }
  __device__ Verdict operator()(std::uint32_t bits) const {
    const std::uint32_t h = mixed(bits ^ seed);
    const float a = operand(mixed(bits), h), b = operand(mixed(~bits ^ seed), h >> 12),
                exact = __fdiv_rn(a, b);
    if (!(exact >= 0x1p-100F && exact <= 0x1p100F)) return left_out;
    return same_bits(particles::quotient(a, b), exact);
  }
};
TEST(Arithmetic, QuotientsAreRoundedCorrectly) {
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) expect_all_right(Quotient{seed}, 1ull << 30);
}

// Quotients of mantissas; some lie close to the midpoint of two adjacent numbers.
struct QuotientOfMantissas {
  __device__ Verdict operator()(std::uint32_t bits) const {
    const float a = __uint_as_float(0x3f800000u | (bits & 0x007fffffu)),
                b = __uint_as_float(0x3f800000u | (0x007fffffu - (bits >> 23) * 16411u));
    return same_bits(particles::quotient(a, b), __fdiv_rn(a, b)) == right
               ? same_bits(particles::quotient(b, a), __fdiv_rn(b, a))
               : wrong;
  }
};
TEST(Arithmetic, QuotientsOfEveryMantissaAreRoundedCorrectly) {
  expect_all_right(QuotientOfMantissas{}, 1ull << 32);
}

struct QuotientOfZero {
  __device__ Verdict operator()(std::uint32_t bits) const {
    const float b = __uint_as_float(bits);
    return b >= 0x1p-100F && b < 0x1p126F ? same_bits(particles::quotient(0, b), 0) : left_out;
  }
};
TEST(Arithmetic, NothingDividedIsNothing) {
  expect_all_right(QuotientOfZero{}, 226ull << 23);
}

}  // namespace
}  // namespace tandem::test
