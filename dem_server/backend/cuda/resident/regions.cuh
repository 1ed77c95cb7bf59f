// The regions of backend/cuda/resident/resident.cuh: which indices each multiprocessor keeps in shared
// memory, which spheres of other regions it needs, and the layout of its arrays.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "dem_server/contact/approach.hpp"
#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/geometry/facet_contact.hpp"
#include "particles/state/window_progress.hpp"

namespace tandem::dem {

// The threads of a block have two tasks. Wall forces need many registers and few threads, pair forces the
// opposite.
inline constexpr unsigned wall_threads = 128;
inline constexpr unsigned pair_threads = 512;
inline constexpr unsigned resident_threads = wall_threads + pair_threads;
inline constexpr unsigned wall_registers = 160, pair_registers = 80;
inline constexpr std::uint32_t resident_spheres = 1024;  // most spheres of a region
inline constexpr std::uint32_t resident_mean = 512;      // most spheres of a region on average
static_assert(resident_mean < resident_spheres - 1);     // see region_begin()
inline constexpr std::uint32_t resident_halo = 1536;     // most spheres of other regions that a region needs
inline constexpr std::uint32_t resident_least = 32;      // fewest spheres that are worth a block
inline constexpr std::uint32_t resident_touches = 256;  // most facet contacts that are kept for the next step
inline constexpr std::size_t resident_static_space = 512;  // shared memory besides Regions::space [B]

// The spheres and list entries of a region, determined at each rebuild.
struct RegionEntries {
  std::uint32_t first = 0, last = 0;  // indices
  std::uint32_t halo = 0;             // number of spheres of other regions that it needs
  Range near, facets;                 // entries of its spheres in ContactLists::near and in the wall list
};
// The grid barrier after each step, and the values that the blocks exchange there; one load fetches all of
// it. Odd and even steps use different halves, so that no block reads a value that another block already
// reports for the next step.
struct alignas(16) GridBarrier {
  unsigned arrived = 0;      // arrivals since the kernel's start
  unsigned error = 0;        // StepError bits; those of odd steps in the upper 16 bits
  unsigned max_speed2[2]{};  // bits of the float
};

struct Regions {
  std::uint32_t count = 0;
  std::size_t space = 0;               // shared memory of a block [B]
  RegionEntries* region = nullptr;     // (count)
  std::uint32_t* halo = nullptr;       // indices (count x resident_halo)
  std::uint16_t* neighbour = nullptr;  // local index of each pair entry: own spheres first, then the halo
  GridBarrier* barrier = nullptr;
};

// A Neighbour by its local index.
struct LocalNeighbour {
  static constexpr std::uint16_t contact_bit = 1u << 15;
  static_assert(resident_spheres + resident_halo <= contact_bit);
  std::uint16_t word;

  __device__ static LocalNeighbour of(std::uint32_t index, bool touched) {
    return {static_cast<std::uint16_t>(index | (touched ? contact_bit : 0u))};
  }
  __device__ std::uint32_t index() const { return word & (contact_bit - 1u); }
  __device__ bool in_contact() const { return word >= contact_bit; }
};

// A pair of the region in contact: first the pair to evaluate, then the result.
template <class Real>
union ResidentContact {
  struct {
    std::uint32_t entry, sphere;
  } pair;
  struct {
    Vec3<Real> force;   // [N]
    Vec3<Real> torque;  // about the centre [N m]
  } on_sphere;

  __device__ ResidentContact() {}
};

// The range of a sphere's contacts in this step, or of its list, counted from the region's first entry.
struct ResidentRange {
  std::uint16_t begin, end;
};

// The load of one sphere on one body.
struct ResidentWallLoad {
  std::int64_t sum[6];  // force and torque in quanta
  std::uint32_t body;
  bool touched;  // the sphere exerts a force on the body
};

// The layout of a region's arrays in shared memory.
template <class Real>
struct ResidentLayout {
  std::uint32_t position, velocity, spin, fine, wall_space, wall_force, wall_owner, wall_touched, wall_touch,
      wall_known, wall_active, wall_load, contact, halo, neighbour, listed, contacts, halo_candidates,
      own_touching, bytes;

  // own: spheres of the region; all: those and the halo; walls: pairs of a sphere and a body near it; facets:
  // wall entries of those; entries: pair entries.
  TANDEM_HD ResidentLayout(std::uint32_t own, std::uint32_t all, std::uint32_t walls, std::uint32_t facets,
                           std::uint32_t entries) {
    bytes = 0;
    position = take(all, sizeof(PositionRadius<Real>));
    velocity = take(all, sizeof(VelocityKind<Real>));
    spin = take(all, sizeof(Spin<Real>));
    fine = take(own, sizeof(FinePart<Real>));
    wall_force = take(walls, sizeof(WallForce<Real>));
    wall_owner = take(facets, sizeof(std::uint16_t));
    wall_touched = take(facets, sizeof(std::uint16_t));
    wall_touch = take(min(facets, resident_touches), sizeof(WallContact));
    wall_known = take(walls, sizeof(std::uint32_t));
    wall_space = take(walls > 0 ? wall_threads / 32 : 0, sizeof(WallContactSpace));
    wall_active = take(2 * walls, sizeof(std::uint16_t));
    wall_load = take(walls, sizeof(ResidentWallLoad));
    contact = take(entries, sizeof(ResidentContact<Real>));
    halo = take(all - own, sizeof(std::uint32_t));
    neighbour = take(entries, sizeof(LocalNeighbour));
    listed = take(own, sizeof(ResidentRange));
    contacts = take(own, sizeof(ResidentRange));
    halo_candidates = take(own, sizeof(std::uint32_t));
    own_touching = take(own, sizeof(std::uint32_t));
  }

 private:
  TANDEM_HD std::uint32_t take(std::uint32_t count, std::size_t size) {
    const std::uint32_t at = bytes;
    bytes += (count * static_cast<std::uint32_t>(size) + 15u) & ~15u;
    return at;
  }
};

// Estimates the cost of sphere i in a step [cycles]; 0 for i = n.
template <class Real>
struct WeighSphere {
  static constexpr std::uint32_t of_contact = 4, of_wall = 50, of_sphere = 13;
  View<Real> view;
  std::uint32_t* work;  // (n + 1)

  __device__ void operator()(std::uint32_t i) const {
    const WindowProgress& c = *view.window;
    work[i] = 0;
    if (i == view.spheres.count || c.error != 0 || c.progress[0].rebuild_due != 0) return;
    const PairList<Real>& pairs = view.lists.pairs;
    const std::uint32_t side = c.progress[0].state_side;
    const PositionRadius<Real>* position = view.spheres.position[side];
    const Range walls = view.near_of(i, view.spheres.velocity[side][i].label);
    std::uint32_t touching = 0;  // ignores periodic images: only the time of a step depends on it
    for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k)
      touching += Approach<Real>::may_touch(position[i], position[pairs.entry[k].index()]);
    work[i] = of_contact * touching + of_wall * (walls.end - walls.begin) + of_sphere;
  }
};

// The count of the numbers 0 to n - 1 for which is_before holds; it must hold up to some number and not from
// there on. All threads of the block must call it. They test numbers at equal distances, and then the numbers
// between two of those, so that the search waits for memory only twice. n must not exceed the square of the
// number of threads.
template <class IsBefore>
__device__ std::uint32_t count_before(std::uint32_t n, IsBefore is_before) {
  const std::uint32_t distance = (n + blockDim.x - 1) / blockDim.x;
  const auto test = [&](std::uint32_t k) { return k < n && is_before(k); };
  const auto marks = static_cast<std::uint32_t>(__syncthreads_count(test(threadIdx.x * distance)));
  if (marks == 0) return 0;
  const std::uint32_t next = (marks - 1) * distance + 1;
  return next + static_cast<std::uint32_t>(
                    __syncthreads_count(threadIdx.x + 1 < distance && test(next + threadIdx.x)));
}

// First index of a region. All regions have equal work and at most resident_spheres spheres. below[i]: work
// of all indices below i. All threads of the block must call it.
template <class Real>
__device__ std::uint32_t region_begin(const View<Real>& view, const std::uint32_t* below,
                                      std::uint32_t region, std::uint32_t regions) {
  const std::uint32_t n = view.spheres.count;
  const std::uint64_t all = below[n];
  // Additional work per sphere, with which resident_spheres spheres make up a region's share.
  const std::uint64_t more = all / (std::uint64_t{regions} * (resident_spheres - 1) - n) + 1;
  const std::uint64_t wanted = (all + more * n) * region / regions;
  return count_before(n, [&](std::uint32_t i) { return below[i] + more * i < wanted; });
}

// One block for each region: determines its indices and its halo, and the local indices of its neighbours.
template <class Real>
__global__ void __launch_bounds__(resident_threads)
    divide_kernel(const __grid_constant__ View<Real> view, const std::uint32_t* work_below,
                  const __grid_constant__ Regions regions) {
  constexpr std::uint32_t hash_size = 4096, free = ~0u;
  __shared__ std::uint32_t key[hash_size];
  __shared__ std::uint16_t number[hash_size];
  __shared__ std::uint32_t halo;
  WindowProgress& window = *view.window;
  // Nothing to do where the lists did not fit or are due for a rebuild, which ends with this kernel. The
  // block decides as a whole, since other blocks may report an error at any time.
  if (__syncthreads_or(window.error != 0 || window.progress[0].rebuild_due != 0) != 0) return;
  if (window.near > blockDim.x * blockDim.x) {  // the limit of count_before(), far more than fit anyway
    if (threadIdx.x == 0) atomicOr(&window.error, static_cast<unsigned>(region_overflow));
    return;
  }
  const PairList<Real>& pairs = view.lists.pairs;
  const std::uint32_t first = region_begin(view, work_below, blockIdx.x, regions.count),
                      last = region_begin(view, work_below, blockIdx.x + 1, regions.count);
  const std::uint32_t begin = pairs.start[first], end = pairs.start[last];
  const auto near_before = [&](std::uint32_t i) {
    return count_before(window.near, [&](std::uint32_t k) { return view.lists.near[k].sphere < i; });
  };
  const auto first_facet = [&](std::uint32_t near) {
    return near < window.near ? view.lists.near[near].first : static_cast<std::uint32_t>(window.wall_entries);
  };
  const Range near{near_before(first), near_before(last)};
  const Range facets{first_facet(near.begin), first_facet(near.end)};
  for (std::uint32_t k = threadIdx.x; k < hash_size; k += blockDim.x) key[k] = free;
  if (threadIdx.x == 0) halo = 0;
  __syncthreads();
  const auto hash_of = [](std::uint32_t j) { return (j * 2654435761u) >> 20; };  // of 4096
  for (std::uint32_t k = begin + threadIdx.x; k < end; k += blockDim.x) {
    const std::uint32_t j = pairs.entry[k].index();
    if (j >= first && j < last) continue;
    for (std::uint32_t at = hash_of(j); *static_cast<volatile std::uint32_t*>(&halo) <= resident_halo;
         at = (at + 1) % hash_size) {
      const std::uint32_t was = atomicCAS(key + at, free, j);
      if (was == j) break;
      if (was != free) continue;
      const std::uint32_t h = atomicAdd(&halo, 1u);
      number[at] = static_cast<std::uint16_t>(h);
      if (h < resident_halo) regions.halo[std::size_t{blockIdx.x} * resident_halo + h] = j;
      break;
    }
  }
  __syncthreads();
  const std::uint32_t own = last - first, walls = near.end - near.begin, listed = facets.end - facets.begin;
  if (halo > resident_halo || own > resident_spheres || end - begin > 0xffff || listed >= 0xffff ||
      ResidentLayout<Real>(own, own + halo, walls, listed, end - begin).bytes > regions.space) {
    if (threadIdx.x == 0) atomicOr(&window.error, static_cast<unsigned>(region_overflow));
    return;
  }
  for (std::uint32_t k = begin + threadIdx.x; k < end; k += blockDim.x) {
    const std::uint32_t j = pairs.entry[k].index();
    std::uint32_t local = j - first;
    if (j < first || j >= last) {
      std::uint32_t at = hash_of(j);
      while (key[at] != j) at = (at + 1) % hash_size;
      local = own + number[at];
    }
    regions.neighbour[k] = static_cast<std::uint16_t>(local);
  }
  if (threadIdx.x == 0) regions.region[blockIdx.x] = {first, last, halo, near, facets};
}

}  // namespace tandem::dem
