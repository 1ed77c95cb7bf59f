// Sums of 64-bit integers over the threads of a warp and of a block.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

namespace tandem::particles {

// A 64-bit sum in shared memory, in two halves: shared memory has a native atomic addition of 32 bits, but
// implements that of 64 bits as a compare-and-swap loop.
struct SplitSum {
  unsigned low, high;

  __device__ void add(std::int64_t amount) {
    const unsigned low_part = static_cast<unsigned>(amount);
    const unsigned before = atomicAdd(&low, low_part);
    const unsigned carry = before + low_part < before ? 1 : 0;
    atomicAdd(&high, static_cast<unsigned>(amount >> 32) + carry);
  }
  __device__ unsigned long long value() const { return static_cast<unsigned long long>(high) << 32 | low; }
};

__device__ inline void add_global(std::int64_t* to, unsigned long long amount) {
  if (amount != 0) atomicAdd(reinterpret_cast<unsigned long long*>(to), amount);
}

// Sum over the threads of a warp, in limbs of 22 bits: the sum of 32 limbs fits the 32 bits that the hardware
// reduces at once. All threads of the warp call it together: a mask of those that happen to be active is not
// enough, since threads may part between asking for the mask and using it.
__device__ inline std::int64_t warp_sum(std::int64_t v) {
  constexpr unsigned mask = ~0u, limb = (1u << 22) - 1;
  const unsigned low = __reduce_add_sync(mask, static_cast<unsigned>(v) & limb);
  const unsigned middle = __reduce_add_sync(mask, static_cast<unsigned>(v >> 22) & limb);
  const int high = __reduce_add_sync(mask, static_cast<int>(v >> 44));
  return low + (static_cast<std::int64_t>(middle) << 22) +
         static_cast<std::int64_t>(static_cast<unsigned long long>(static_cast<long long>(high)) << 44);
}

}  // namespace tandem::particles
