// The sum over a sphere's contacts with other spheres, for laws that need neither histories nor spins. One
// thread traverses the list of its sphere without shared memory, and reads each neighbour once. WarpGather
// (backend/cuda/streaming/warp_gather.cuh) reads neighbours in contact twice in order to keep all threads
// busy. Both sum in the same order.
#pragma once

#include "dem_server/backend/cuda/streaming/fetch_ahead.cuh"
#include "dem_server/contact/pair_forces.hpp"
#include "dem_server/contact/pair_sum.hpp"

namespace tandem::dem {

template <class Law, class Real>
struct LaneGather {
  static_assert(!Law::tangential && !Law::extended);
  static constexpr std::uint32_t together = 2;  // candidates at a time: more would need too many registers
  static_assert(2 * together <= entries_read_ahead);
  struct Space {};

  __device__ explicit LaneGather(Space&) {}
  __device__ static std::uint32_t thread() { return threadIdx.x & 31u; }
  __device__ static bool moves() { return true; }

  // i may be beyond the last sphere.
  template <class Forces, class Tally>
  __device__ ForceSum operator()(const Forces& forces, std::uint32_t i, Tally& tally) const {
    ForceSum sum;
    if (i >= forces.view.spheres.owned.end) return sum;
    const auto& state = forces.state;
    const std::uint32_t end = fetch(forces.list.start + i + 1);
    std::uint32_t k = fetch(forces.list.start + i);
    const PositionRadius<Real> own = state.position(i);
    const VelocityKind<Real> own_velocity = state.velocity(i);
    Neighbour neighbour[together];
#pragma unroll
    for (std::uint32_t t = 0; t < together; ++t) neighbour[t] = fetch_here(state.neighbours + k + t);
    for (; k < end; k += together) {
      PositionRadius<Real> position[together];
      VelocityKind<Real> velocity[together];
#pragma unroll
      for (std::uint32_t t = 0; t < together; ++t)
        position[t] = fetch_here(state.positions + neighbour[t].index());
#pragma unroll
      for (std::uint32_t t = 0; t < together; ++t)
        velocity[t] = fetch_here(state.velocities + neighbour[t].index());
        // The next neighbours, too: this takes one load out of the chain of dependent loads.
#pragma unroll
      for (std::uint32_t t = 0; t < together; ++t)
        neighbour[t] = fetch_here(state.neighbours + k + together + t);
#pragma unroll
      for (std::uint32_t t = 0; t < together; ++t) {
        const Approach<Real> approach(own, position[t]);
        if ((k + t < end) & approach.touching())
          sum.force += forces.force(own, own_velocity, position[t], velocity[t], approach, tally)
                           .template as<double>();
      }
    }
    return sum;
  }
};

}  // namespace tandem::dem
