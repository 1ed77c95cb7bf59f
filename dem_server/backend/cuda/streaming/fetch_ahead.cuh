// Speculative loads: they start before it is known whether their data is needed.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "dem_server/laws/particle_names.hpp"
#include "particles/backend/traits.hpp"

namespace tandem::dem {

// Entries that a kernel may read beyond the end of a list. They are indices of spheres, though of arbitrary
// ones.
inline constexpr std::uint32_t entries_read_ahead = CudaTraits::read_ahead;

// Like fetch() of particles/base/fetch.hpp, but the load stays where it is written: a compiler would defer it
// to the branch that uses its value.
template <class T>
__device__ T fetch_here(const T* from) {
  static_assert(sizeof(T) % 16 == 0 || sizeof(T) == 4);
  T value;
  if constexpr (sizeof(T) == 4) {
    int word;
    asm volatile("ld.global.nc.s32 %0, [%1];" : "=r"(word) : "l"(from));
    memcpy(&value, &word, sizeof(word));
  } else {
    for (std::size_t k = 0; k < sizeof(T); k += 16) {
      int4 word;
      asm volatile("ld.global.nc.v4.s32 {%0, %1, %2, %3}, [%4];"
                   : "=r"(word.x), "=r"(word.y), "=r"(word.z), "=r"(word.w)
                   : "l"(reinterpret_cast<const std::byte*>(from) + k));
      memcpy(reinterpret_cast<std::byte*>(&value) + k, &word, sizeof(word));
    }
  }
  return value;
}

// Loads data of a later access into the caches.
__device__ inline void prefetch(const void* where) {
  asm volatile("prefetch.global.L1 [%0];" ::"l"(where));
}

}  // namespace tandem::dem
