// The results of a step that all threads contribute to, reduced within a block before it writes to global
// memory.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "common/math/vec3.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/backend/cuda/block_sum.cuh"
#include "particles/base/fixed_point.hpp"
#include "particles/state/window_progress.hpp"

namespace tandem::dem {

// Results of one block, or of one warp.
struct BlockTally {
  unsigned max_speed2, max_overlap_ratio;  // bits of non-negative floats, which sort like the floats
  unsigned error, culprit, lost, touched;
};

// Results of the spheres that one thread moves.
struct MotionTally {
  BlockTally* block;
  std::int64_t* load;  // of this step
  float speed2 = 0, overlap_ratio = 0;

  __device__ void observe_speed(float s2) { speed2 = fmaxf(speed2, s2); }
  __device__ void observe_overlap(float ratio) { overlap_ratio = fmaxf(overlap_ratio, ratio); }
  __device__ void raise(StepError what, std::uint32_t id) {
    atomicOr(&block->error, static_cast<unsigned>(what));
    atomicMin(&block->culprit, dem::culprit(what, id));
  }
  __device__ void count_lost() { atomicAdd(&block->lost, 1u); }
  __device__ void add_load(std::uint32_t row, Vec3d force, Vec3d torque, Quantum f, Quantum t) {
    const std::int64_t add[6] = {to_fixed(force.x, f),  to_fixed(force.y, f),  to_fixed(force.z, f),
                                 to_fixed(torque.x, t), to_fixed(torque.y, t), to_fixed(torque.z, t)};
    for (int k = 0; k < 6; ++k)
      add_global(load + std::size_t{row} * 6 + k, static_cast<unsigned long long>(add[k]));
  }
};

// The load that one thread contributes to one body. The threads of a warp add their loads up before they
// write to shared memory.
struct WallTally {
  BlockTally* block;
  float overlap_ratio = 0;
  bool touched = false;
  std::int64_t sum[6]{};

  __device__ void observe_overlap(float ratio) { overlap_ratio = fmaxf(overlap_ratio, ratio); }
  __device__ void raise(StepError what, std::uint32_t id) {
    atomicOr(&block->error, static_cast<unsigned>(what));
    atomicMin(&block->culprit, dem::culprit(what, id));
  }
  __device__ void add_load(std::uint32_t, Vec3d force, Vec3d torque, Quantum f, Quantum t) {
    for (int a = 0; a < 3; ++a) {
      sum[a] += to_fixed(force[a], f);
      sum[3 + a] += to_fixed(torque[a], t);
    }
    touched = true;
  }

  // All threads of the warp must call it. `shared` holds the rows below rows_shared, `load` holds all rows.
  __device__ void flush(std::uint32_t body, SplitSum* shared, std::uint32_t rows_shared, std::int64_t* load) {
    for (unsigned left = __ballot_sync(~0u, touched); left != 0;) {
      const std::uint32_t row = __shfl_sync(~0u, body, __ffs(static_cast<int>(left)) - 1);
      const bool of_row = touched && body == row;
      left &= ~__ballot_sync(~0u, of_row);
#pragma unroll
      for (unsigned k = 0; k < 6; ++k) {
        const std::int64_t total = warp_sum(of_row ? sum[k] : 0);
        if ((threadIdx.x & 31) != k) continue;
        if (row < rows_shared)
          shared[row * 6 + k].add(total);
        else
          add_global(load + std::size_t{row} * 6 + k, static_cast<unsigned long long>(total));
      }
      block->touched = 1;
    }
    clear();
  }
  __device__ void clear() {
    touched = false;
    for (std::int64_t& s : sum) s = 0;
  }
};

// Adds the largest values of a warp to those of the block.
__device__ inline void gather(float speed2, float overlap_ratio, BlockTally& block) {
  const unsigned fastest = __reduce_max_sync(~0u, __float_as_uint(speed2));
  const unsigned deepest = __reduce_max_sync(~0u, __float_as_uint(overlap_ratio));
  if ((threadIdx.x & 31) == 0) {
    if (fastest > block.max_speed2) atomicMax(&block.max_speed2, fastest);
    if (deepest > block.max_overlap_ratio) atomicMax(&block.max_overlap_ratio, deepest);
  }
}

// Adds the results that a block, or a warp, has of the step on `side` to those of the window.
__device__ inline void report(const BlockTally& block, WindowProgress& window, unsigned side) {
  // The largest values seldom grow: a load costs less than an atomic of every block on one address.
  if (block.max_speed2 > __float_as_uint(window.max_speed2[side ^ 1]))
    atomicMax(reinterpret_cast<unsigned*>(&window.max_speed2[side ^ 1]), block.max_speed2);
  if (block.max_overlap_ratio > __float_as_uint(window.max_overlap_ratio))
    atomicMax(reinterpret_cast<unsigned*>(&window.max_overlap_ratio), block.max_overlap_ratio);
  if (block.error != 0) {
    atomicOr(&window.error, block.error);
    atomicOr(&window.step_error[side ^ 1], block.error);
    atomicMin(&window.culprit, block.culprit);
  }
  if (block.lost != 0) atomicAdd(reinterpret_cast<unsigned long long*>(&window.lost), block.lost);
}

// Loads data that other blocks may have written while this kernel runs: bypasses the L1 cache of this
// multiprocessor.
template <class T>
__device__ T load_uncached(const T* from) {
  using Word = std::conditional_t<alignof(T) % 16 == 0, int4, int>;
  T value;
  for (std::size_t k = 0; k < sizeof(T) / sizeof(Word); ++k)
    reinterpret_cast<Word*>(&value)[k] = __ldcg(reinterpret_cast<const Word*>(from) + k);
  return value;
}

}  // namespace tandem::dem
