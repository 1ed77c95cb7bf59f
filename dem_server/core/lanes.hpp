// How many lanes work on one sphere, and in which order their partial sums meet.
//
// Entry k of a sphere's list belongs to lane k mod 4, and the total is ((s0 + s1) + (s2 + s3)). A GPU gives each lane
// a thread and meets by shuffles; the CPU keeps the four sums itself. The order, hence the bits, are the same.
#pragma once

#include <cstdint>

#include "common/host_device.hpp"

namespace tandem::dem {

inline constexpr std::uint32_t lanes_per_sphere = 4;

// One thread plays all lanes.
struct SerialLanes {
  // Sum over k in [begin, end) of what add(k, sum) adds.
  template <class Sum, class Add>
  TANDEM_HD Sum sum_over(std::uint32_t begin, std::uint32_t end, Add add) const {
    Sum part[lanes_per_sphere]{};
    for (std::uint32_t k = begin; k < end; ++k) add(k, part[(k - begin) % lanes_per_sphere]);
    part[0] += part[1];
    part[2] += part[3];
    part[0] += part[2];
    return part[0];
  }
  TANDEM_HD bool leads() const { return true; }
};

#if defined(__CUDACC__)
// Four neighbouring threads of a warp.
struct WarpLanes {
  std::uint32_t lane;  // 0..3

  template <class Sum, class Add>
  __device__ Sum sum_over(std::uint32_t begin, std::uint32_t end, Add add) const {
    Sum sum{};
    for (std::uint32_t k = begin + lane; k < end; k += lanes_per_sphere) add(k, sum);
    // Addition commutes, so the butterfly gives every lane the same bits as SerialLanes.
    const unsigned group = 0xfu << (threadIdx.x & 28u);
    sum.shuffle_add(group, 1);
    sum.shuffle_add(group, 2);
    return sum;
  }
  __device__ bool leads() const { return lane == 0; }
};
#endif

}  // namespace tandem::dem
