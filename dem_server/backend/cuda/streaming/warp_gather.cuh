// The sum over a sphere's contacts with other spheres on a GPU. Each pair is evaluated from both sides, so
// that no force is written to memory. The order is that of contact/pair_sum.hpp. LaneGather
// (backend/cuda/streaming/lane_gather.cuh) replaces it for very many spheres without friction.
#pragma once

#include "dem_server/backend/cuda/component_sum.cuh"
#include "dem_server/backend/cuda/streaming/fetch_ahead.cuh"
#include "dem_server/contact/pair_forces.hpp"
#include "dem_server/contact/pair_sum.hpp"

namespace tandem::dem {

// A warp processes 32 / lanes spheres. `lanes` threads test the candidates of one sphere. Candidates in
// contact go to a list of the warp, from which each thread takes the next contact, whichever sphere it
// belongs to: spheres have 0 to 12 contacts, and threads that are bound to a sphere would wait for the one
// with most contacts. Finally one thread sums the contacts of its sphere and moves the sphere. Few threads
// per sphere are the least work; more threads have the lower latency where there are too few spheres to keep
// the device busy. A sphere with very many candidates, a large one among small ones, is processed by the
// whole warp after the others.
template <class Law, class Real, std::uint32_t lanes_, Levels levels>
struct WarpGather {
  static constexpr std::uint32_t lanes = lanes_, spheres = 32 / lanes;
  static constexpr std::uint32_t tests = 4;       // candidates that a thread tests at once
  static constexpr std::uint32_t chunk = 32;      // candidates of a sphere that are tested together
  static constexpr std::uint32_t long_list = 64;  // the whole warp processes a sphere with more candidates
  static constexpr std::uint32_t capacity = lanes == 2        ? 128
                                            : Law::tangential ? 224
                                                              : 256;  // contacts evaluated together
  static_assert((lanes == 1 || lanes == 2) && chunk <= entries_read_ahead && chunk % (tests * lanes) == 0);
  static_assert(32 * tests <= capacity);

  struct Force {
    Vec3<Real> force;  // [N]
  };
  struct ForceAndTorque {
    Vec3<Real> force;   // [N]
    Vec3<Real> torque;  // about the centre [N m]
  };
  using OnSphere = std::conditional_t<Law::tangential, ForceAndTorque, Force>;
  // A contact: first the pair to evaluate, then the result.
  union Contact {
    struct {
      std::uint32_t entry, sphere;
    } pair;
    OnSphere on_sphere;

    __device__ Contact() {}
  };
  struct Space {  // in shared memory, one for each warp
    Contact contact[capacity];
  };
  Space& space;

  __device__ static std::uint32_t thread() { return threadIdx.x & 31u; }
  __device__ static std::uint32_t lane() { return threadIdx.x % lanes; }
  __device__ bool moves() const { return lane() == 0; }

  // All threads of the warp must call it. i increases from sphere to sphere within the warp, and may be
  // beyond the last sphere. The result is valid in the thread that moves the sphere.
  template <class Forces, class Tally>
  __device__ ForceSum operator()(const Forces& forces, std::uint32_t i, Tally& tally) const {
    const bool exists = i < forces.view.spheres.owned.end;
    const std::uint32_t first = i - thread() / lanes, end = exists ? fetch(forces.list.start + i + 1) : 0;
    const PositionRadius<Real> own = exists ? forces.state.position(i) : PositionRadius<Real>{};
    ForceSum sum;
    std::uint32_t from = exists ? fetch(forces.list.start + i) : 0;
    unsigned with_long_list = 0;
    if constexpr (levels == Levels::many) {
      with_long_list = __ballot_sync(~0u, moves() && end - from > long_list);
      if (end - from > long_list) from = end;
    }
    for (; __any_sync(~0u, from < end); from = min(from + chunk, end)) {
      const unsigned of_sphere = find(forces, own, from, end);
      // A prefix sum yields where the contacts of this sphere begin in the warp's list, and its length.
      const std::uint32_t contacts = static_cast<std::uint32_t>(__popc(of_sphere));
      std::uint32_t last = contacts;
#pragma unroll
      for (unsigned distance = lanes; distance < 32; distance *= 2) {
        const std::uint32_t below = __shfl_up_sync(~0u, last, distance);
        if (thread() >= distance) last += below;
      }
      const std::uint32_t all = __shfl_sync(~0u, last, 31), begin = last - contacts;
      for (std::uint32_t base = 0; base < all; base += capacity) {
        list(of_sphere, from, begin - base);
        __syncwarp();
        const std::uint32_t batch = all - base < capacity ? all - base : capacity;
        evaluate(forces, first, batch, tally);
        __syncwarp();
        if (moves()) add(sum, begin < base ? 0 : begin - base, last < base ? 0 : last - base, batch);
        __syncwarp();
      }
    }
    for (; with_long_list != 0; with_long_list &= with_long_list - 1)
      sum_one(forces, first, static_cast<unsigned>(__ffs(static_cast<int>(with_long_list))) - 1, sum, tally);
    return sum;
  }

 private:
  // Bit k: candidate from + k of the sphere may be in contact with it, or was in the last step. To keep the
  // result for some steps, as the CPU does, is slower here: the contacts need the same data next.
  template <class Forces>
  __device__ static unsigned find(const Forces& forces, const PositionRadius<Real>& own, std::uint32_t from,
                                  std::uint32_t end) {
    unsigned found = 0;
    for (std::uint32_t k = 0; k < chunk && __any_sync(~0u, from + k < end); k += tests * lanes) {
      // Candidates beyond the end are tested, too, so that all loads start at once from one address.
      const std::size_t at = std::size_t{from} + k + lane();
#pragma unroll
      for (std::uint32_t t = 0; t < tests; ++t)
        if (forces.may_touch(own, at + t * lanes)) found |= 1u << (k + t * lanes + lane());
    }
    if constexpr (lanes == 2) found |= __shfl_xor_sync(~0u, found, 1);
    const std::uint32_t listed = end - from;
    return listed < chunk ? found & ((1u << listed) - 1) : found;
  }
  // Writes this thread's share of the pairs of its sphere, whose first one goes to position `at`. Pairs
  // outside the list are skipped.
  __device__ void list(unsigned of_sphere, std::uint32_t from, std::uint32_t at) const {
    unsigned mine = lanes == 1 ? of_sphere : of_sphere & (0x55555555u << lane());
    for (; mine != 0; mine &= mine - 1) {
      const std::uint32_t bit = static_cast<std::uint32_t>(__ffs(static_cast<int>(mine))) - 1;
      const std::uint32_t before = static_cast<std::uint32_t>(__popc(of_sphere & ((1u << bit) - 1)));
      // Positions before the list wrap around to ones beyond it, since they are unsigned.
      if (at + before < capacity) space.contact[at + before].pair = {from + bit, thread() / lanes};
    }
  }
  // While one contact is evaluated, the next neighbour is loaded and its spring is prefetched.
  template <class Forces, class Tally>
  __device__ void evaluate(const Forces& forces, std::uint32_t first, std::uint32_t batch,
                           Tally& tally) const {
    Neighbour next{};
    if (thread() < batch) next = forces.state.neighbour(space.contact[thread()].pair.entry);
    for (std::uint32_t c = thread(); c < batch; c += 32) {
      const Neighbour neighbour = next;
      if (c + 32 < batch) {
        const std::uint32_t entry = space.contact[c + 32].pair.entry;
        next = forces.state.neighbour(entry);
        if constexpr (Law::tangential) prefetch(forces.list.spring + entry);
      }
      Contact& contact = space.contact[c];
      TouchingPair<Real> m;
      PairResult<Real> r;
      Vec3<Real> moment;
      const bool touching =
          forces(first + contact.pair.sphere, contact.pair.entry, neighbour, m, r, moment, tally);
      contact.on_sphere.force = selected(touching, r.force);
      if constexpr (Law::tangential)
        contact.on_sphere.torque = selected(touching, (m.radius - r.overlap / 2) * r.couple + moment);
    }
  }
  // A selection instead of a branch: a compiler could move the whole evaluation of v into a branch.
  __device__ static Vec3<Real> selected(bool take, Vec3<Real> v) {
    return {take ? v.x : Real(0), take ? v.y : Real(0), take ? v.z : Real(0)};
  }
  __device__ void add(ForceSum& sum, std::uint32_t begin, std::uint32_t end, std::uint32_t batch) const {
    const std::uint32_t stop = end < batch ? end : batch;
    for (std::uint32_t c = begin; c < stop; ++c) {
      const OnSphere& of = space.contact[c].on_sphere;
      sum.force += of.force.template as<double>();
      if constexpr (Law::tangential) sum.torque += of.torque.template as<double>();
    }
  }

  // All threads of the warp sum the contacts of the sphere that thread `mover` moves, which gets the sum.
  template <class Forces, class Tally>
  __device__ void sum_one(const Forces& forces, std::uint32_t first, unsigned mover, ForceSum& sum,
                          Tally& tally) const {
    const std::uint32_t sphere = mover / lanes, end = fetch(forces.list.start + first + sphere + 1);
    const PositionRadius<Real> own = forces.state.position(first + sphere);
    ComponentSum<Law::tangential> of_all;
    for (std::uint32_t from = fetch(forces.list.start + first + sphere); from < end; from += 32 * tests) {
      std::uint32_t listed = 0;
#pragma unroll
      for (std::uint32_t t = 0; t < tests; ++t) {
        const std::uint32_t k = from + t * 32 + thread();
        const unsigned found = __ballot_sync(~0u, k < end && forces.may_touch(own, k));
        if (found >> thread() & 1u)
          space.contact[listed + static_cast<std::uint32_t>(__popc(found & ((1u << thread()) - 1)))].pair = {
              k, sphere};
        listed += static_cast<std::uint32_t>(__popc(found));
      }
      __syncwarp();
      evaluate(forces, first, listed, tally);
      __syncwarp();
      of_all.add(space.contact, listed);
      __syncwarp();
    }
    of_all.give(mover, sum);
  }
};

}  // namespace tandem::dem
