// The device's square roots and quotients of contacts are those of IEEE 754, as the host's are: compared with
// the compiler's own, which know the whole range.
#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include <cstdint>

#include "dem_server/contact/arithmetic.hpp"

namespace tandem::test {
namespace {

// Numbers of operands for which `wrong` is true, of 2^32.
template <class Wrong>
__global__ void count_kernel(Wrong wrong, unsigned long long* count) {
  unsigned mine = 0;
  for (std::uint64_t bits = blockIdx.x * blockDim.x + threadIdx.x; bits < std::uint64_t{1} << 32;
       bits += gridDim.x * blockDim.x)
    mine += wrong(static_cast<std::uint32_t>(bits)) ? 1 : 0;
  if (mine > 0) atomicAdd(count, static_cast<unsigned long long>(mine));
}

template <class Wrong>
unsigned long long count(Wrong wrong) {
  unsigned long long* on_device = nullptr;
  unsigned long long found = ~0ull;
  EXPECT_EQ(cudaMalloc(&on_device, sizeof(found)), cudaSuccess);
  EXPECT_EQ(cudaMemset(on_device, 0, sizeof(found)), cudaSuccess);
  count_kernel<<<1024, 256>>>(wrong, on_device);
  EXPECT_EQ(cudaMemcpy(&found, on_device, sizeof(found), cudaMemcpyDeviceToHost), cudaSuccess);
  cudaFree(on_device);
  return found;
}

struct Root {
  __device__ bool operator()(std::uint32_t bits) const {
    const float x = __uint_as_float(bits);
    return x >= 0x1p-100F && x < INFINITY && __float_as_uint(dem::root(x)) != __float_as_uint(__fsqrt_rn(x));
  }
};
TEST(Arithmetic, RootsAreRoundedCorrectlyForEveryOperand) {
  EXPECT_EQ(count(Root{}), 0u);
}

struct Reciprocal {
  __device__ bool operator()(std::uint32_t bits) const {
    const float x = __uint_as_float(bits), size = fabsf(x);
    return size >= 0x1p-126F && size < 0x1p126F &&
           __float_as_uint(dem::reciprocal(x)) != __float_as_uint(__frcp_rn(x));
  }
};
TEST(Arithmetic, ReciprocalsAreRoundedCorrectlyForEveryOperand) {
  EXPECT_EQ(count(Reciprocal{}), 0u);
}

// Operands from mixed bits (the finaliser of MurmurHash3), of exponents that keep the quotient in range.
struct Quotient {
  std::uint32_t seed;

  __device__ static std::uint32_t mixed(std::uint32_t h) {
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
  }
  __device__ static float operand(std::uint32_t bits) {  // from 2^-48 to 2^48
    return __uint_as_float((bits & 0x007fffffu) | ((127u - 48u + bits % 96u) << 23));
  }
  __device__ bool operator()(std::uint32_t bits) const {
    const float a = operand(mixed(bits)), b = operand(mixed(~bits ^ seed));
    return __float_as_uint(dem::quotient(a, b)) != __float_as_uint(__fdiv_rn(a, b));
  }
};
TEST(Arithmetic, QuotientsAreRoundedCorrectly) {
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) EXPECT_EQ(count(Quotient{seed}), 0u);
}

// One mantissa over every other: quotients near the middle between two numbers are among them.
struct QuotientOfMantissas {
  __device__ bool operator()(std::uint32_t bits) const {
    const float a = __uint_as_float(0x3f800000u | (bits & 0x007fffffu)),
                b = __uint_as_float(0x3f800000u | (0x007fffffu - (bits >> 23) * 16411u));
    return __float_as_uint(dem::quotient(a, b)) != __float_as_uint(__fdiv_rn(a, b)) ||
           __float_as_uint(dem::quotient(b, a)) != __float_as_uint(__fdiv_rn(b, a));
  }
};
TEST(Arithmetic, QuotientsOfEveryMantissaAreRoundedCorrectly) {
  EXPECT_EQ(count(QuotientOfMantissas{}), 0u);
}

struct QuotientOfZero {
  __device__ bool operator()(std::uint32_t bits) const {
    const float b = __uint_as_float(bits);
    return b >= 0x1p-100F && b <= 0x1p100F && __float_as_uint(dem::quotient(0, b)) != 0;
  }
};
TEST(Arithmetic, NothingDividedIsNothing) {
  EXPECT_EQ(count(QuotientOfZero{}), 0u);
}

}  // namespace
}  // namespace tandem::test
