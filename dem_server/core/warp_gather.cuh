// The sum over a sphere's contacts with others, the GPU's way: each pair is evaluated from both sides, so
// that no force is written to memory. Same order as contact/pair_sum.hpp.
#pragma once

#include "dem_server/contact/pair_forces.hpp"
#include "dem_server/contact/pair_sum.hpp"

namespace tandem::dem {

// A warp does 16 spheres. Two threads share a sphere's candidates; those that touch go to a list of the warp,
// and then each thread takes the next contact off that list, whosever it is: spheres have 0 to 12 contacts,
// and threads bound to a sphere would wait for the one with most. At last one of the two threads adds up the
// forces and moves the sphere, the other adds up the torques and turns it.
template <class Real>
struct WarpGather {
  static constexpr std::uint32_t lanes = 2, spheres = 32 / lanes;
  static constexpr std::uint32_t tests = 8;       // candidates that a thread tests at once
  static constexpr std::uint32_t capacity = 128;  // contacts that are done together

  struct OnSphere {
    Vec3<Real> force;   // [N]
    Vec3<Real> torque;  // about the centre [N m]
  };
  struct Space {  // in shared memory, one for each warp
    std::uint32_t entry[capacity];
    std::uint8_t sphere[capacity];
    OnSphere force[capacity];
  };
  Space& space;

  __device__ static std::uint32_t thread() { return threadIdx.x & 31u; }
  __device__ static std::uint32_t lane() { return threadIdx.x % lanes; }
  __device__ bool moves() const { return lane() == 0; }
  __device__ bool turns() const { return lane() == 1; }

  // All threads of the warp call it; i counts on from sphere to sphere within the warp, and may be beyond the
  // last.
  template <class Forces, class Tally>
  __device__ ForceSum operator()(const Forces& forces, std::uint32_t i, Tally& tally) const {
    const bool exists = i < forces.view.n;
    const std::uint32_t first = i - thread() / lanes, end = exists ? fetch(forces.list.start + i + 1) : 0;
    const Place<Real> own = exists ? forces.state.place(i) : Place<Real>{};
    Vec3d sum;  // of force where this thread moves the sphere, of torque where it turns it
    for (std::uint32_t chunk = exists ? fetch(forces.list.start + i) : 0; __any_sync(~0u, chunk < end);
         chunk += tests * lanes) {
      unsigned found = 0;  // bit m: candidate chunk + m * lanes + lane
      if (chunk < end) {
        // Past the end the last entry is tested again, so that all loads can be under way at once.
#pragma unroll
        for (std::uint32_t m = 0; m < tests; ++m) {
          const std::uint32_t k = chunk + m * lanes + lane();
          const bool hit = forces.may_touch(own, k < end ? k : end - 1);
          if (hit && k < end) found |= 1u << (m * lanes + lane());
        }
      }
      const unsigned of_sphere = found | __shfl_xor_sync(~0u, found, 1);
      // Where the contacts of this sphere begin in the warp's list, and how many that has.
      const std::uint32_t contacts = static_cast<std::uint32_t>(__popc(of_sphere));
      std::uint32_t last = contacts;
#pragma unroll
      for (unsigned distance = lanes; distance < 32; distance *= 2) {
        const std::uint32_t below = __shfl_up_sync(~0u, last, distance);
        if (thread() >= distance) last += below;
      }
      const std::uint32_t all = __shfl_sync(~0u, last, 31), begin = last - contacts;
      for (std::uint32_t base = 0; base < all; base += capacity) {
        list(found, of_sphere, chunk, begin, base);
        __syncwarp();
        const std::uint32_t batch = all - base < capacity ? all - base : capacity;
        for (std::uint32_t c = thread(); c < batch; c += 32)
          space.force[c] = evaluate(forces, first + space.sphere[c], space.entry[c], tally);
        __syncwarp();
        add(sum, begin < base ? 0 : begin - base, last < base ? 0 : last - base, batch);
        __syncwarp();
      }
    }
    return moves() ? ForceSum{sum, {}} : ForceSum{{}, sum};
  }

 private:
  template <class Forces, class Tally>
  __device__ static OnSphere evaluate(const Forces& forces, std::uint32_t i, std::uint32_t k, Tally& tally) {
    PairMeeting<Real> m;
    PairResult<Real> r;
    Vec3<Real> moment;
    const bool touching = forces(i, k, m, r, moment, tally);
    const Vec3<Real> torque = (m.radius - r.overlap / 2) * r.couple + moment;
    return {selected(touching, r.force), selected(touching, torque)};
  }
  // Not a branch, into which a compiler could move all that leads to v.
  __device__ static Vec3<Real> selected(bool take, Vec3<Real> v) {
    return {take ? v.x : Real(0), take ? v.y : Real(0), take ? v.z : Real(0)};
  }
  // Writes this thread's finds that fall into [base, base + capacity) of the warp's list.
  __device__ void list(unsigned found, unsigned of_sphere, std::uint32_t chunk, std::uint32_t begin,
                       std::uint32_t base) const {
    for (; found != 0; found &= found - 1) {
      const unsigned bit = found & (0u - found);
      const std::uint32_t at = begin + static_cast<std::uint32_t>(__popc(of_sphere & (bit - 1))) - base;
      if (at >= capacity) continue;  // before `base` too, since at is unsigned
      space.entry[at] = chunk + static_cast<std::uint32_t>(__ffs(static_cast<int>(bit))) - 1;
      space.sphere[at] = static_cast<std::uint8_t>(thread() / lanes);
    }
  }
  __device__ void add(Vec3d& sum, std::uint32_t begin, std::uint32_t end, std::uint32_t batch) const {
    const std::uint32_t stop = end < batch ? end : batch;
    for (std::uint32_t c = begin; c < stop; ++c)
      sum += (moves() ? space.force[c].force : space.force[c].torque).template as<double>();
  }
};

}  // namespace tandem::dem
