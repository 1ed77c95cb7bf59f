// The sum over a sphere's contacts with others for laws that keep nothing of a contact from step to step.
// Same interface and same order as core/warp_gather.cuh, of one thread for each sphere.
//
// Without histories the first-level cache is what a step waits for, by the number of lines that its loads ask
// for. So the place of a neighbour that touches is kept where it has been loaded, and contacts stand in the
// order in which they are found: those of neighbouring spheres side by side, whose own state lies in few
// lines.
#pragma once

#include "dem_server/contact/pair_forces.hpp"
#include "dem_server/contact/pair_sum.hpp"
#include "dem_server/core/warp_gather.cuh"

namespace tandem::dem {

template <class Law, class Real>
struct WarpGatherPlaces {
  static_assert(!Law::tangential && !Law::extended);
  static constexpr std::uint32_t tests = 4;       // candidates that a thread tests at once
  static constexpr std::uint32_t chunk = 32;      // candidates of a sphere that are looked through together
  static constexpr std::uint32_t capacity = 192;  // contacts that are done together
  static constexpr std::uint32_t most_found = 32 * tests;  // between two looks at what room is left
  static_assert(chunk <= entries_read_ahead && chunk % tests == 0 && most_found < capacity);

  // In shared memory, one for each warp: contacts, in the order in which they were found.
  struct Space {
    union Contact {
      Place<Real> other;
      Vec3<Real> force;  // that came of it, on the sphere that found it [N]

      __device__ Contact() {}
    };
    Contact contact[capacity];
    std::uint32_t slot[capacity];   // of the other one
    std::uint8_t finder[capacity];  // thread
  };
  Space& space;

  __device__ static std::uint32_t thread() { return threadIdx.x & 31u; }
  __device__ bool moves() const { return true; }

  // All threads of the warp call it; i counts on from thread to thread, and may be beyond the last sphere.
  template <class Forces, class Tally>
  __device__ ForceSum operator()(const Forces& forces, std::uint32_t i, Tally& tally) const {
    const bool exists = i < forces.view.n;
    const std::uint32_t first = i - thread(), end = exists ? fetch(forces.list.start + i + 1) : 0;
    const Place<Real> own = exists ? forces.state.place(i) : Place<Real>{};
    ForceSum sum;
    for (std::uint32_t from = exists ? fetch(forces.list.start + i) : 0; __any_sync(~0u, from < end);
         from = min(from + chunk, end)) {
      unsigned touching = 0;  // bit k: candidate from + k of the sphere may touch it
      std::uint32_t listed = 0, done = 0;
      for (std::uint32_t k = 0; k < chunk && __any_sync(~0u, from + k < end); k += tests) {
        if (listed + most_found > capacity) {
          add(sum, forces, first, touching, done, listed, tally);
          done = k;
          listed = 0;
        }
        touching |= find(forces, own, std::size_t{from} + k, end, listed) << k;
      }
      add(sum, forces, first, touching, done, listed, tally);
    }
    return sum;
  }

 private:
  __device__ static std::uint32_t below(unsigned found) {
    return static_cast<std::uint32_t>(__popc(found & ((1u << thread()) - 1)));
  }

  // Lists those of the sphere's candidates from `at` on that may touch it; bit t: candidate at + t.
  template <class Forces>
  __device__ unsigned find(const Forces& forces, const Place<Real>& own, std::size_t at, std::uint32_t end,
                           std::uint32_t& listed) const {
    std::uint32_t slot[tests];
    Place<Real> place[tests];
    // Beyond the end, too: so all loads are under way at once, by one address.
#pragma unroll
    for (std::uint32_t t = 0; t < tests; ++t) slot[t] = forces.state.neighbour(at + t).slot();
#pragma unroll
    for (std::uint32_t t = 0; t < tests; ++t) place[t] = forces.state.place(slot[t]);
    unsigned touching = 0;
#pragma unroll
    for (std::uint32_t t = 0; t < tests; ++t) {
      const bool touches = at + t < end && Approach<Real>::may_touch(own, place[t]);
      const unsigned found = __ballot_sync(~0u, touches);
      if (touches) {
        const std::uint32_t c = listed + below(found);
        space.contact[c].other = place[t];
        space.slot[c] = slot[t];
        space.finder[c] = static_cast<std::uint8_t>(thread());
        touching |= 1u << t;
      }
      listed += static_cast<std::uint32_t>(__popc(found));
    }
    return touching;
  }

  // Evaluates all that is listed, and adds up what the sphere's contacts do: bits of `touching` from `from`
  // on.
  template <class Forces, class Tally>
  __device__ void add(ForceSum& sum, const Forces& forces, std::uint32_t first, unsigned touching,
                      std::uint32_t from, std::uint32_t listed, Tally& tally) const {
    __syncwarp();
    for (std::uint32_t c = thread(); c < listed; c += 32) {
      const std::uint32_t i = first + space.finder[c];
      PairResult<Real> r;
      const bool touches =
          forces.between(i, forces.state.place(i), space.slot[c], space.contact[c].other, r, tally);
      // Not a branch, into which a compiler could move all that leads to the force.
      space.contact[c].force = {touches ? r.force.x : Real(0), touches ? r.force.y : Real(0),
                                touches ? r.force.z : Real(0)};
    }
    __syncwarp();
    for (std::uint32_t k = from, at = 0; at < listed; ++k) {
      const bool touches = (touching >> k & 1u) != 0;
      const unsigned found = __ballot_sync(~0u, touches);
      if (touches) sum.force += space.contact[at + below(found)].force.template as<double>();
      at += static_cast<std::uint32_t>(__popc(found));
    }
    __syncwarp();
  }
};

template <class Law, class Real, std::uint32_t lanes>
struct WarpGatherOf {
  using Type = WarpGather<Law, Real, lanes>;
};
template <class Law, class Real>
requires(!Law::tangential && !Law::extended) struct WarpGatherOf<Law, Real, 1> {
  using Type = WarpGatherPlaces<Law, Real>;
};
template <class Law, class Real, std::uint32_t lanes>
using GatherOf = typename WarpGatherOf<Law, Real, lanes>::Type;

}  // namespace tandem::dem
