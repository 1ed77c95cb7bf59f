// How many lanes work on one sphere, and in which order their partial sums meet.
//
// A list is worked off in chunks of 16 entries. First all lanes test the chunk's candidates; then contact number c of
// the chunk goes to lane c mod lanes, so that no lane waits for others that found nothing to do. The lanes' sums meet
// as neighbours, then as neighbouring pairs. A GPU gives each lane a thread and meets by shuffles; the CPU keeps the
// sums itself. The order, hence the bits, are the same.
#pragma once

#include <bit>
#include <cstdint>

#include "common/host_device.hpp"

namespace tandem::dem {

inline constexpr std::uint32_t lanes_per_sphere = 2;
inline constexpr std::uint32_t chunk_entries = 16;

// One thread plays all lanes.
struct SerialLanes {
  // Sum of what add(k, sum) adds over those k in [begin, end) for which test(k).
  template <class Sum, class Test, class Add>
  TANDEM_HD Sum sum_over(std::uint32_t begin, std::uint32_t end, Test test, Add add) const {
    Sum part[lanes_per_sphere]{};
    for (std::uint32_t chunk = begin; chunk < end; chunk += chunk_entries) {
      const std::uint32_t chunk_end = end - chunk < chunk_entries ? end : chunk + chunk_entries;
      std::uint32_t contact = 0;
      for (std::uint32_t k = chunk; k < chunk_end; ++k)
        if (test(k)) add(k, part[contact++ % lanes_per_sphere]);
    }
    for (std::uint32_t distance = 1; distance < lanes_per_sphere; distance *= 2)
      for (std::uint32_t lane = 0; lane < lanes_per_sphere; lane += 2 * distance)
        part[lane] += part[lane + distance];
    return part[0];
  }
  TANDEM_HD bool leads() const { return true; }
};

#if defined(__CUDACC__)
// Neighbouring threads of a warp.
struct WarpLanes {
  std::uint32_t lane;  // 0 .. lanes_per_sphere - 1

  template <class Sum, class Test, class Add>
  __device__ Sum sum_over(std::uint32_t begin, std::uint32_t end, Test test, Add add) const {
    constexpr std::uint32_t lanes = lanes_per_sphere;
    const unsigned group = ((1u << lanes) - 1) << (threadIdx.x & 31u & ~(lanes - 1));
    Sum sum{};
    for (std::uint32_t chunk = begin; chunk < end; chunk += chunk_entries) {
      const std::uint32_t last = end - chunk - 1;
      unsigned found = 0;
      // Past the end the last entry is tested again, so that all loads can be under way at once.
#pragma unroll
      for (std::uint32_t k = 0; k < chunk_entries; k += lanes) {
        const std::uint32_t at = k + lane;
        const bool hit = test(chunk + (at < last ? at : last));
        if (hit && at <= last) found |= 1u << at;
      }
      for (unsigned distance = 1; distance < lanes; distance *= 2)
        found |= __shfl_xor_sync(group, found, distance);
      for (std::uint32_t skip = 0; skip < lane; ++skip) found &= found - 1;
      while (found != 0) {
        add(chunk + static_cast<std::uint32_t>(__ffs(static_cast<int>(found))) - 1, sum);
        for (std::uint32_t skip = 0; skip < lanes; ++skip) found &= found - 1;
      }
      __syncwarp(group);
    }
    // Addition commutes, so the butterfly gives every lane the same bits as SerialLanes.
    for (unsigned distance = 1; distance < lanes; distance *= 2)
      sum.shuffle_add(group, static_cast<int>(distance));
    return sum;
  }
  __device__ bool leads() const {
    return lane == 0;
  }
};
#endif

}  // namespace tandem::dem
