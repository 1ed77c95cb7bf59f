// Threads that share the facets near one particle.
#pragma once

#include <cstdint>

#include "common/host_device.hpp"

namespace tandem::sph {

// Facets are dealt out to as many lanes. Back ends add the sums of the lanes up in their order, so that a
// thread that takes all lanes in turn and threads that take one each get the same bits.
inline constexpr std::uint32_t wall_lanes = 4;

// A team is what a step sees of these threads: sum(of_lane) gives each of them the sum of of_lane(lane) over
// all lanes, and one of them leads.
struct OneThreadTeam {
  template <class OfLane>
  TANDEM_HD auto sum(OfLane of_lane) const {
    auto sum = of_lane(0u);
#ifdef __CUDACC__
#pragma unroll 1  // of_lane is long
#endif
    for (std::uint32_t lane = 1; lane < wall_lanes; ++lane) sum.add(of_lane(lane));
    return sum;
  }
  TANDEM_HD static bool leads() {
    return true;
  }
};

}  // namespace tandem::sph
