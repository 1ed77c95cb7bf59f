// Micro steps with the spheres in shared memory, for scenes that fit there (about 60,000 spheres on an H100).
// Each multiprocessor has a region: a range of indices, which are sorted by position. It keeps the state of
// these spheres from one rebuild of the lists to the next. A step reads from global memory only the halo, the
// neighbours that belong to other regions, and writes the state that other regions may need:
//
//   barrier ─► halo ─► pairs in contact ─► forces of pairs and walls ─► motion ─► publish ─► barrier
//
// While the blocks wait at the barrier, they find the contacts of the next step that need no halo: those with
// facets and those within the region. A step then costs one grid barrier instead of two launches, and its
// loads stay on the multiprocessor. It runs the functors of the other kernels with the same sums in the same
// order, so that the bits are the same.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "dem_server/backend/cuda/block_tally.cuh"
#include "dem_server/backend/cuda/resident/grid_barrier.cuh"
#include "dem_server/backend/cuda/resident/regions.cuh"
#include "dem_server/contact/pair_sum.hpp"
#include "dem_server/contact/state_in_memory.hpp"
#include "dem_server/contact/wall_forces.hpp"

namespace tandem::dem {

// The facets listed for a sphere and a body, with the contacts that look_ahead() has found. `touched` is 0
// for a facet without contact, else 1 + the number of the contact. `touch` holds the first resident_touches
// contacts; later ones are computed again.
struct TouchedFacets {
  const std::uint32_t* entry;
  const std::uint16_t* touched;
  const WallContact* touch;

  __device__ std::uint32_t operator[](int i) const { return fetch(entry + i); }
};
__device__ inline bool touches_facet(const TouchedFacets& near, int i, Vec3d centre_B, double radius,
                                     const Facet* facets, WallContact& k) {
  const unsigned touched = near.touched[i];
  if (touched == 0) return false;
  if (touched > resident_touches) return touch_facet(facets, near[i], centre_B, radius, k);
  k = near.touch[touched - 1];
  return true;
}

// The state of a region, with the interface of contact/state_in_memory.hpp. Indices of the halo follow those
// of the region's own spheres. State that other regions may need is also written to global memory.
template <class Real>
struct StateInRegion {
  const View<Real>& view;
  std::uint32_t first, first_entry, first_wall, first_facet, side;
  PositionRadius<Real>* positions;
  VelocityKind<Real>* velocities;
  Spin<Real>* spins;
  FinePart<Real>* fine_parts;
  WallForce<Real>* wall_forces;
  LocalNeighbour* neighbours;
  const std::uint16_t* wall_touched;
  const WallContact* wall_touch;

  __device__ PositionRadius<Real> position(std::uint32_t i) const { return positions[i - first]; }
  __device__ VelocityKind<Real> velocity(std::uint32_t i) const { return velocities[i - first]; }
  __device__ std::uint32_t kind(std::uint32_t i) const { return velocities[i - first].kind(); }
  __device__ Spin<Real> spin(std::uint32_t i) const { return spins[i - first]; }
  __device__ FinePart<Real> fine(std::uint32_t i) const { return fine_parts[i - first]; }
  __device__ Neighbour neighbour(std::uint32_t k) const {
    const LocalNeighbour local = neighbours[k - first_entry];
    return Neighbour::of(first + local.index(), local.in_contact());
  }
  __device__ void set_neighbour(std::uint32_t k, Neighbour other) const {
    neighbours[k - first_entry] = LocalNeighbour::of(other.index() - first, other.in_contact());
    // The list in global memory has the global index.
    view.lists.pairs.entry[k] = Neighbour::of(view.lists.pairs.entry[k].index(), other.in_contact());
  }
  __device__ TouchedFacets facets(std::uint32_t from, const CurrentStep& now) const {
    return {view.lists.walls.entry + from, wall_touched + (from - first_facet), wall_touch};
  }
  __device__ const WallForce<Real>& wall_force(std::uint32_t which) const {
    return wall_forces[which - first_wall];
  }
  __device__ void set_wall_force(std::uint32_t which, const WallForce<Real>& force) const {
    store(wall_forces + (which - first_wall), force);
  }

  __device__ void move(std::uint32_t i, const PositionRadius<Real>& position,
                       const VelocityKind<Real>& velocity) const {
    positions[i - first] = view.spheres.position[side ^ 1][i] = position;
    velocities[i - first] = view.spheres.velocity[side ^ 1][i] = velocity;
  }
  __device__ void set_spin(std::uint32_t i, const Spin<Real>& spin) const {
    spins[i - first] = view.spheres.spin[side ^ 1][i] = spin;
  }
  __device__ void set_fine_part(std::uint32_t i, const FinePart<Real>& fine) const {
    fine_parts[i - first] = fine;
  }
};

// Shared memory of a block besides the arrays of ResidentLayout.
struct ResidentShared {
  StepProgress progress;
  BlockTally block;
  std::uint32_t contacts;  // pairs in contact that have been found in this step
  std::uint32_t walls[2];  // entries of wall_active, in even and odd steps
  std::uint32_t touches;   // contacts with facets in the next step
};

// The region of a block, and the parts of a step on it.
template <class Step, Levels levels>
struct ResidentRegion {
  using Real = typename Step::Real;
  using Law = typename Step::Law;

  const Step& step;
  const View<Real>& view = step.view;
  ResidentShared& shared;
  RegionEntries region;
  std::uint32_t steps, rows;
  double dt;
  const PairList<Real>& pairs = view.lists.pairs;
  std::uint32_t own = region.last - region.first, all = own + region.halo;
  std::uint32_t first_entry = pairs.start[region.first], entries = pairs.start[region.last] - first_entry;
  std::uint32_t first_wall = region.near.begin, walls = region.near.end - first_wall;
  std::byte* space;
  std::uint32_t first_facet = region.facets.begin, facets = region.facets.end - first_facet;
  ResidentLayout<Real> at{own, all, walls, facets, entries};
  PositionRadius<Real>* position = array<PositionRadius<Real>>(at.position);
  VelocityKind<Real>* velocity = array<VelocityKind<Real>>(at.velocity);
  Spin<Real>* spin = array<Spin<Real>>(at.spin);
  FinePart<Real>* fine = array<FinePart<Real>>(at.fine);
  WallForce<Real>* wall_force = array<WallForce<Real>>(at.wall_force);
  std::uint16_t* wall_owner = array<std::uint16_t>(at.wall_owner);  // of each facet: its number in `walls`
  // Of each facet, for the next step; see TouchedFacets.
  std::uint16_t* wall_touched = array<std::uint16_t>(at.wall_touched);
  WallContact* wall_touch = array<WallContact>(at.wall_touch);
  std::uint32_t* wall_known = array<std::uint32_t>(at.wall_known);  // of `walls`: stamp of the last contact
  // Those of `walls` that are in contact, in even and odd steps.
  std::uint16_t* wall_active = array<std::uint16_t>(at.wall_active);
  ResidentWallLoad* wall_load = array<ResidentWallLoad>(at.wall_load);
  ResidentContact<Real>* contact = array<ResidentContact<Real>>(at.contact);
  std::uint32_t* halo = array<std::uint32_t>(at.halo);
  LocalNeighbour* neighbour = array<LocalNeighbour>(at.neighbour);
  ResidentRange* listed = array<ResidentRange>(at.listed);      // of each sphere, in `neighbour`
  ResidentRange* contacts = array<ResidentRange>(at.contacts);  // of each sphere, in `contact`
  // Bits of the first 32 candidates of each sphere: those in the halo, and those of its own region that are
  // in contact with it.
  unsigned* halo_candidates = array<unsigned>(at.halo_candidates);
  unsigned* own_touching = array<unsigned>(at.own_touching);

  __device__ StateInRegion<Real> state(const CurrentStep& now) const {
    return {view,     region.first, first_entry, first_wall, first_facet, now.state_side, position,
            velocity, spin,         fine,        wall_force, neighbour,   wall_touched,   wall_touch};
  }
  __device__ CurrentStep now() const { return {dt, shared.progress}; }
  __device__ std::int64_t* load(const CurrentStep& now) const {
    return view.load + std::size_t{now.step} * rows * 6;
  }

  // Loads the region into shared memory. All threads of the block must call it.
  __device__ void fill(const Regions& regions, std::uint32_t side) const {
    const std::uint32_t t = threadIdx.x;
    for (std::uint32_t s = t; s < own; s += blockDim.x) {
      const std::uint32_t i = region.first + s;
      position[s] = view.spheres.position[side][i];
      velocity[s] = view.spheres.velocity[side][i];
      if constexpr (Law::tangential) spin[s] = view.spheres.spin[side][i];
      fine[s] = view.spheres.fine_part(i);
      listed[s] = {static_cast<std::uint16_t>(pairs.start[i] - first_entry),
                   static_cast<std::uint16_t>(pairs.start[i + 1] - first_entry)};
    }
    for (std::uint32_t h = t; h < region.halo; h += blockDim.x)
      halo[h] = regions.halo[std::size_t{blockIdx.x} * resident_halo + h];
    for (std::uint32_t k = t; k < entries; k += blockDim.x)
      neighbour[k] = LocalNeighbour::of(regions.neighbour[first_entry + k],
                                        Law::tangential && pairs.entry[first_entry + k].in_contact());
    for (std::uint32_t w = t; w < walls; w += blockDim.x) {
      const NearBody near = view.lists.near[first_wall + w];
      wall_load[w].body = near.body;
      wall_known[w] = view.window->progress[0].stamp - 1;
      for (std::uint32_t k = 0; k < near.count; ++k)
        wall_owner[near.first - first_facet + k] = static_cast<std::uint16_t>(w);
    }
  }
  // To be called after fill(). Each thread processes the spheres that it processes in the look_ahead() that
  // follows.
  __device__ void find_halo_candidates() const {
    for (std::uint32_t s = threadIdx.x; s < own; s += blockDim.x) {
      const ResidentRange of = listed[s];
      unsigned in_halo = 0;
      for (unsigned k = 0; k < 32 && of.begin + k < of.end; ++k)
        if (neighbour[of.begin + k].index() >= own) in_halo |= 1u << k;
      halo_candidates[s] = in_halo;
    }
  }
  __device__ void save_fine_parts() const {
    if constexpr (has_fine_part<Real>)
      for (std::uint32_t s = threadIdx.x; s < own; s += blockDim.x)
        view.spheres.fine[region.first + s] = fine[s];
  }

  // Finds the contacts of the next step that do not depend on the halo: those of the region's spheres with
  // facets and with each other. It changes nothing else, so that the next step need not take place.
  __device__ void look_ahead(const CurrentStep& at_next, unsigned t, unsigned threads) const {
    if (at_next.step >= steps) return;
    const StateInRegion<Real> where = state(at_next);
    const auto forces = step.walls(at_next, where);
    const unsigned half = at_next.step % 2;
    for (std::uint32_t w = t; w < walls; w += threads) wall_force[w] = {};
    // Starts with the last thread: regions with walls have few spheres, which the first threads process.
    for (std::uint32_t k = threads - 1 - t; k < facets; k += threads) {
      const std::uint32_t w = wall_owner[k];
      WallContact touch;
      wall_touched[k] = 0;
      if (!forces.touches(first_wall + w, first_facet + k, touch)) continue;
      const std::uint32_t number = atomicAdd(&shared.touches, 1u);
      if (number < resident_touches) wall_touch[number] = touch;
      wall_touched[k] = static_cast<std::uint16_t>(number + 1);
      if (atomicExch(wall_known + w, at_next.stamp) != at_next.stamp)
        wall_active[half * walls + atomicAdd(shared.walls + half, 1u)] = static_cast<std::uint16_t>(w);
    }
    const auto pair_forces = step.pairs(at_next, where);
    for (std::uint32_t s = t; s < own; s += threads) {
      const ResidentRange of = listed[s];
      const std::uint32_t begin = first_entry + of.begin, end = first_entry + of.end,
                          first = min(of.end - of.begin, 32);
      const PositionRadius<Real> self = position[s];
      unsigned touching = 0;
      for (std::uint32_t k = 0; k < first; k += 4) {
#pragma unroll
        for (std::uint32_t n = k; n < k + 4; ++n)  // beyond the end: the last one again
          touching |= static_cast<unsigned>(pair_forces.may_touch(self, min(begin + n, end - 1))) << n;
      }
      if (first < 32) touching &= (1u << first) - 1;
      // The halo still has the positions of the previous step, or none: its candidates are left out.
      own_touching[s] = touching & ~halo_candidates[s];
    }
  }

  // To be called by the wall threads, `t` from 0 on.
  __device__ void wall_forces(unsigned t) const {
    const unsigned lane = t % 32;
    const CurrentStep at_now = now();
    const StateInRegion<Real> where = state(at_now);
    const auto forces = step.walls(at_now, where);
    const std::uint32_t active = shared.walls[at_now.step % 2];
    const std::uint16_t* which = wall_active + at_now.step % 2 * walls;
    if (t == 0) shared.touches = 0;
    WallContactSpace& many = array<WallContactSpace>(at.wall_space)[t / 32];
    WallTally tally{&shared.block};
    for (std::uint32_t a = t; a - lane < active; a += wall_threads) {
      const bool exists = a < active;
      const std::uint32_t w = exists ? which[a] : 0;
      const bool done = !exists || forces.compute_few_contacts(first_wall + w, tally);
      // Spheres with many contacts are few; they use the memory of their warp one after the other.
      for (unsigned left = __ballot_sync(~0u, !done); left != 0; left &= left - 1) {
        if (lane + 1 == static_cast<unsigned>(__ffs(static_cast<int>(left))))
          forces.compute_any_contacts(first_wall + w, many, tally);
        __syncwarp();
      }
      if (exists) wall_load[w].touched = tally.touched;
      if (tally.touched) {
        for (int k = 0; k < 6; ++k) wall_load[w].sum[k] = tally.sum[k];
        tally.clear();
      }
    }
    __syncwarp();
    gather(0, tally.overlap_ratio, shared.block);
  }
  // Adds up the loads on the bodies, while the pair threads move the spheres.
  __device__ void report_loads(unsigned t, std::uint32_t at_step, std::int64_t* load) const {
    const unsigned half = at_step % 2;
    const std::uint32_t sums = view.surface.bodies * 6, active = shared.walls[half];
    const std::uint16_t* which = wall_active + half * walls;
    if (sums <= wall_threads) {
      for (std::uint32_t s = t / 32; s < sums; s += wall_threads / 32) {
        std::int64_t mine = 0;
        for (std::uint32_t a = t % 32; a < active; a += 32) {
          const ResidentWallLoad& of = wall_load[which[a]];
          mine += of.touched && of.body == s / 6 ? of.sum[s % 6] : 0;
        }
        const std::int64_t sum = warp_sum(mine);
        if (t % 32 == 0) add_global(load + s, static_cast<unsigned long long>(sum));
      }
    } else {
      for (std::uint32_t a = t; a < active; a += wall_threads) {
        const ResidentWallLoad& of = wall_load[which[a]];
        for (int k = 0; k < 6 && of.touched; ++k)
          add_global(load + std::size_t{of.body} * 6 + k, static_cast<unsigned long long>(of.sum[k]));
      }
    }
    sync_block<BlockBarrier::walls>();
    if (t == 0) shared.walls[half] = 0;
  }

  // To be called by the pair threads, `t` from 0 on. All loads come first, so that none waits for another.
  __device__ void fetch_halo(unsigned t) const {
    constexpr std::uint32_t shares = (resident_halo + pair_threads - 1) / pair_threads;
    const std::uint32_t side = shared.progress.state_side;
    PositionRadius<Real> positions[shares];
    VelocityKind<Real> velocities[shares];
    Spin<Real> spins[shares];
#pragma unroll
    for (std::uint32_t k = 0; k < shares; ++k) {
      const std::uint32_t h = t + k * pair_threads;
      if (h >= region.halo) continue;
      const std::uint32_t j = halo[h];
      positions[k] = load_uncached(view.spheres.position[side] + j);
      velocities[k] = load_uncached(view.spheres.velocity[side] + j);
      if constexpr (Law::tangential) spins[k] = load_uncached(view.spheres.spin[side] + j);
    }
#pragma unroll
    for (std::uint32_t k = 0; k < shares; ++k) {
      const std::uint32_t h = t + k * pair_threads;
      if (h >= region.halo) continue;
      position[own + h] = positions[k];
      velocity[own + h] = velocities[k];
      if constexpr (Law::tangential) spin[own + h] = spins[k];
    }
  }
  // Finds the pairs in contact. The contacts of a sphere are contiguous and in the order of its list.
  template <class Forces>
  __device__ void find_contacts(const Forces& forces, unsigned t) const {
    const unsigned lane = t % 32;
    for (std::uint32_t s = t; s - lane < own; s += pair_threads) {
      const PositionRadius<Real> self = s < own ? position[s] : PositionRadius<Real>{};
      const ResidentRange of = s < own ? listed[s] : ResidentRange{};
      const std::uint32_t begin = first_entry + of.begin, end = first_entry + of.end;
      unsigned touching = s < own ? own_touching[s] : 0;
      for (unsigned left = s < own ? halo_candidates[s] : 0; left != 0;) {  // two at a time
        const unsigned one = left & -left, rest = left ^ one, other = rest != 0 ? rest & -rest : one;
        const bool one_touches = forces.may_touch(self, begin + lowest_bit(one)),
                   other_touches = forces.may_touch(self, begin + lowest_bit(other));
        touching |= (one_touches ? one : 0) | (other_touches ? other : 0);
        left = rest & ~other;
      }
      std::uint32_t found = static_cast<std::uint32_t>(__popc(touching));
      const unsigned long_lists = levels == Levels::many ? __ballot_sync(~0u, end - begin > 32) : 0;
      if constexpr (levels == Levels::many) {
        for (unsigned left = long_lists; left != 0; left &= left - 1) {
          const std::uint32_t owner = lowest_bit(left);
          for_touching_beyond(forces, s - lane + owner, [&](std::uint32_t, unsigned touch) {
            if (lane == owner) found += static_cast<std::uint32_t>(__popc(touch));
          });
        }
      } else {
        for (std::uint32_t k = begin + 32; k < end; ++k) found += forces.may_touch(self, k);
      }
      std::uint32_t last = found;
      for (unsigned distance = 1; distance < 32; distance *= 2) {
        const std::uint32_t below = __shfl_up_sync(~0u, last, distance);
        if (lane >= distance) last += below;
      }
      std::uint32_t base = 0;
      if (lane == 31 && last > 0) base = atomicAdd(&shared.contacts, last);
      last += __shfl_sync(~0u, base, 31);
      std::uint32_t c = last - found;
      if (s < own) contacts[s] = {static_cast<std::uint16_t>(c), static_cast<std::uint16_t>(last)};
      for (; touching != 0; touching &= touching - 1)
        contact[c++].pair = {begin + lowest_bit(touching), region.first + s};
      if constexpr (levels == Levels::many) {
        for (unsigned left = long_lists; left != 0; left &= left - 1) {
          const std::uint32_t owner = lowest_bit(left);
          std::uint32_t next = __shfl_sync(~0u, c, static_cast<int>(owner));
          for_touching_beyond(forces, s - lane + owner, [&](std::uint32_t k, unsigned touch) {
            const unsigned before = touch & ((1u << lane) - 1);
            if (touch >> lane & 1u)
              contact[next + static_cast<std::uint32_t>(__popc(before))].pair = {
                  k, region.first + s - lane + owner};
            next += static_cast<std::uint32_t>(__popc(touch));
          });
        }
      } else {
        for (std::uint32_t k = begin + 32; c < last; ++k)
          if (forces.may_touch(self, k)) contact[c++].pair = {k, region.first + s};
      }
    }
  }
  // The warp processes the entries beyond the 32nd of a sphere that is large among small ones, one entry per
  // thread at a time. Calls f(k, touch) with this thread's entry k; bit t of `touch` says whether the
  // entry of thread t may be in contact.
  template <class Forces, class F>
  __device__ void for_touching_beyond(const Forces& forces, std::uint32_t s, F f) const {
    const PositionRadius<Real> self = position[s];
    const ResidentRange of = listed[s];
    for (std::uint32_t first = of.begin + 32; first < of.end; first += 32) {
      const std::uint32_t k = first + threadIdx.x % 32;
      f(first_entry + k, __ballot_sync(~0u, k < of.end && forces.may_touch(self, first_entry + k)));
    }
  }
  // Thread t evaluates contacts t, t + pair_threads, ..., whichever sphere they belong to.
  template <class Forces>
  __device__ void evaluate_contacts(const Forces& forces, unsigned t, MotionTally& tally) const {
    for (std::uint32_t c = t; c < shared.contacts; c += pair_threads) {
      TouchingPair<Real> m;
      PairResult<Real> r;
      Vec3<Real> moment;
      const bool touch = forces(contact[c].pair.sphere, contact[c].pair.entry, m, r, moment, tally);
      const Vec3<Real> torque = (m.radius - r.overlap / 2) * r.couple + moment;
      contact[c].on_sphere = {touch ? r.force : Vec3<Real>{}, touch ? torque : Vec3<Real>{}};
    }
  }
  template <class Motion>
  __device__ void move(const Motion& motion, unsigned t, MotionTally& tally) const {
    for (std::uint32_t s = t; s < own; s += pair_threads) {
      const std::uint32_t i = region.first + s;
      const auto self = motion.own(i);
      ForceSum sum;
      const ResidentRange of = contacts[s];
#pragma unroll 2
      for (std::uint32_t c = of.begin; c < of.end; ++c) {
        sum.force += contact[c].on_sphere.force.template as<double>();
        if constexpr (Law::tangential) sum.torque += contact[c].on_sphere.torque.template as<double>();
      }
      motion.translate(i, self, sum.force, tally);
      if constexpr (Law::tangential) motion.rotate(i, self, sum.torque);
    }
  }

  // To be called by one thread: reports the results of this block, waits for those of all blocks, and decides
  // whether another step follows.
  __device__ void decide(GridBarrier* where, unsigned barrier_count, double skin, double body_speed) const {
    const unsigned half = barrier_count % 2, error_shift = half * 16;
    BlockTally& block = shared.block;
    StepProgress& progress = shared.progress;
    shared.contacts = 0;
    if (block.max_speed2 > __float_as_uint(progress.max_speed2))
      atomicMax(&where->max_speed2[half], block.max_speed2);
    if (block.error != 0) atomicOr(&where->error, block.error << error_shift);
    const GridBarrier seen = wait_for_all_blocks(where, barrier_count * gridDim.x);
    const unsigned error = (seen.error >> error_shift) & 0xffffu;
    block.error |= error & blocks_apart;
    close_step(__uint_as_float(half == 0 ? seen.max_speed2[0] : seen.max_speed2[1]), dt, skin,
               view.window->skins, body_speed, progress);
    progress.open = progress.step < steps && progress.rebuild_due == 0 && error == 0;
  }

 private:
  // Number of the lowest bit that is set.
  __device__ static std::uint32_t lowest_bit(unsigned bits) {
    return static_cast<std::uint32_t>(__ffs(static_cast<int>(bits))) - 1;
  }
  template <class T>
  __device__ T* array(std::uint32_t where) const {
    return reinterpret_cast<T*>(space + where);
  }
};

// Does all steps until the lists are due for a rebuild, the window is done or a step fails.
template <class Step, Levels levels>
__global__ void __launch_bounds__(resident_threads, 1)
    resident_kernel(const __grid_constant__ Step step, const __grid_constant__ Regions regions,
                    std::uint32_t rows) {
  using Region = ResidentRegion<Step, levels>;
  extern __shared__ __align__(16) std::byte space[];
  __shared__ ResidentShared shared;
  WindowProgress& window = *step.view.window;
  if (window.error != 0 || window.progress[0].step >= window.steps || window.progress[0].rebuild_due != 0)
    return;

  const Region region{.step = step,
                      .shared = shared,
                      .region = regions.region[blockIdx.x],
                      .steps = window.steps,
                      .rows = rows,
                      .dt = window.dt,
                      .space = space};
  const double skin = window.skin, body_speed = window.body_speed;
  region.fill(regions, window.progress[0].state_side);
  if (threadIdx.x == 0) {
    shared.progress = next_step(window, 0);
    shared.block = {0, 0, 0, ~0u, 0, 0};
    shared.contacts = shared.walls[0] = shared.walls[1] = shared.touches = 0;
  }
  __syncthreads();
  region.find_halo_candidates();
  region.look_ahead(region.now(), threadIdx.x, resident_threads);
  __syncthreads();

  if (threadIdx.x < wall_threads) {
    set_registers<wall_registers, true>();
    while (shared.progress.open != 0) {
      const CurrentStep now = region.now();
      sync_block<BlockBarrier::walls>();  // see BlockBarrier
      region.wall_forces(threadIdx.x);
      sync_block<BlockBarrier::walls>();  // see BlockBarrier
      sync_block<BlockBarrier::forces>();
      region.report_loads(threadIdx.x, now.step, region.load(now));
      sync_block<BlockBarrier::decision>();
    }
  } else {
    set_registers<pair_registers, false>();
    const unsigned t = threadIdx.x - wall_threads;
    for (unsigned barrier_count = 1; shared.progress.open != 0; ++barrier_count) {
      const CurrentStep now = region.now();
      const auto state = region.state(now);
      const auto forces = step.pairs(now, state);
      MotionTally tally{&shared.block, region.load(now)};
      region.fetch_halo(t);
      sync_block<BlockBarrier::pairs>();
      region.find_contacts(forces, t);
      sync_block<BlockBarrier::pairs>();
      region.evaluate_contacts(forces, t, tally);
      sync_block<BlockBarrier::forces>();
      region.move(step.motion(now, state), t, tally);
      __syncwarp();
      gather(tally.speed2, tally.overlap_ratio, shared.block);
      sync_block<BlockBarrier::pairs>();
      if (t == 0) region.decide(regions.barrier, barrier_count, skin, body_speed);
      if (t >= 32) {
        CurrentStep next = now;
        ++next.step;
        ++next.stamp;
        region.look_ahead(next, t - 32, pair_threads - 32);
      }
      sync_block<BlockBarrier::decision>();
    }
  }
  region.save_fine_parts();
  if (threadIdx.x == 0) {
    shared.block.max_speed2 = 0;  // decide() has reported it
    report(shared.block, window, 0);
    if (blockIdx.x == 0) window.progress[0] = shared.progress;
  }
}

}  // namespace tandem::dem
