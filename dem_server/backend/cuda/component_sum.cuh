// The sum over the contacts of a sphere that has very many of them, a large one among small ones. One thread
// of the warp sums each component, in the order in which a single thread would add.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "dem_server/contact/pair_sum.hpp"

namespace tandem::dem {

template <bool with_torque>
class ComponentSum {
 public:
  // All threads of a warp must call it. The contacts are in shared memory.
  template <class Contact>
  __device__ void add(const Contact* contact, std::uint32_t count) {
    if (thread() >= components) return;
    for (std::uint32_t c = 0; c < count; ++c) {
      const auto& of = contact[c].on_sphere;
      if (!with_torque || thread() < 3)
        mine_ += static_cast<double>(of.force[thread()]);
      else if constexpr (with_torque)
        mine_ += static_cast<double>(of.torque[thread() - 3]);
    }
  }
  // Hands the sum to thread `to` of the warp.
  __device__ void give(std::uint32_t to, ForceSum& sum) const {
#pragma unroll
    for (int k = 0; k < components; ++k) {
      const double component = __shfl_sync(~0u, mine_, k);
      if (thread() == static_cast<int>(to)) (k < 3 ? sum.force : sum.torque)[k % 3] = component;
    }
  }

 private:
  static constexpr int components = with_torque ? 6 : 3;
  __device__ static int thread() {
    return static_cast<int>(threadIdx.x % 32);
  }
  double mine_ = 0;
};

}  // namespace tandem::dem
