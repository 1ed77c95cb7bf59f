// A micro step with the spheres in global memory, for scenes that do not fit into shared memory
// (backend/cuda/resident/resident.cuh). One kernel computes the forces of walls on the spheres near them, the
// other one sums the forces between spheres and moves all spheres. The second kernel may start before the
// first has ended (backend/cuda/exec_cuda.cuh).
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "dem_server/backend/cuda/block_tally.cuh"
#include "dem_server/backend/cuda/streaming/lane_gather.cuh"
#include "dem_server/backend/cuda/streaming/warp_gather.cuh"
#include "dem_server/contact/state_in_memory.hpp"
#include "dem_server/contact/wall_forces.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/state/window_progress.hpp"

namespace tandem::dem {

inline constexpr unsigned step_block_threads = 128;
// Least number of blocks of the step kernel on one multiprocessor, which bounds the registers
// (docs/experiments/2026-11-gpu-through-memory.md).
template <class Law>
inline constexpr unsigned step_blocks = Law::tangential ? 7 : 9;
// Three blocks for each multiprocessor of an H100: more would leave no room for the step kernel.
inline constexpr unsigned wall_block_threads = 64, largest_wall_blocks = 396;
inline constexpr std::uint32_t shared_rows = 128;  // load rows that a block sums in shared memory

// Programmatic dependencies exist from compute capability 9.0 on; elsewhere kernels run one after the other.
__device__ inline void wait_for_kernel_before() {
#if __CUDA_ARCH__ >= 900
  cudaGridDependencySynchronize();
#endif
}
__device__ inline void let_next_kernel_start() {
#if __CUDA_ARCH__ >= 900
  cudaTriggerProgrammaticLaunchCompletion();
#endif
}

// The bound of one block lets the compiler use the 182 registers that it needs. Without the bound it keeps to
// 168, which is slower (docs/experiments/2026-11-gpu-through-memory.md).
template <class Step>
__global__ void __launch_bounds__(wall_block_threads, 1)
    wall_kernel(const __grid_constant__ Step step, std::uint32_t rows, unsigned side) {
  WindowProgress& window = *step.view.window;
  __shared__ StepProgress progress;
  __shared__ BlockTally block;
  __shared__ SplitSum load_sum[shared_rows * 6];
  __shared__ WallContactSpace space[wall_block_threads / 32];
  const std::uint32_t rows_shared = rows < shared_rows ? rows : shared_rows;
  for (std::uint32_t k = threadIdx.x; k < rows_shared * 6; k += blockDim.x) load_sum[k] = {0, 0};
  wait_for_kernel_before();
  // The step kernel may start now: it reads the results of the previous step only, and waits before it reads
  // those of this kernel.
  let_next_kernel_start();
  if (threadIdx.x == 0) {
    progress = next_step(window, side);
    block = {0, 0, 0, ~0u, 0, 0};
  }
  __syncthreads();
  if (progress.open == 0) return;

  const CurrentStep now(window, progress);
  const StateInMemory<typename Step::Real> state(step.view, now);
  const auto walls = step.walls(now, state);
  std::int64_t* load = step.view.load + std::size_t{now.step} * rows * 6;
  WallTally tally{&block};
  for (std::uint32_t first = blockIdx.x * blockDim.x; first < window.near; first += gridDim.x * blockDim.x) {
    const std::uint32_t which = first + threadIdx.x;
    const bool done = which >= window.near || walls.compute_few_contacts(which, tally);
    // Spheres with many contacts are few; they use the memory of their warp one after the other.
    for (unsigned left = __ballot_sync(~0u, !done); left != 0; left &= left - 1) {
      if ((threadIdx.x & 31) + 1 == static_cast<unsigned>(__ffs(static_cast<int>(left))))
        walls.compute_any_contacts(which, space[threadIdx.x / 32], tally);
      __syncwarp();
    }
    tally.flush(which < window.near ? step.view.lists.near[which].body : 0, load_sum, rows_shared, load);
  }
  __syncwarp();
  gather(0, tally.overlap_ratio, block);
  __syncthreads();
  if (block.touched != 0)
    for (std::uint32_t k = threadIdx.x; k < rows_shared * 6; k += blockDim.x)
      add_global(load + k, load_sum[k].value());
  if (threadIdx.x == 0) report(block, window, side);
}

template <class Law, class Real, std::uint32_t lanes, Levels levels>
using GatherOf = std::conditional_t<!Law::tangential && !Law::extended && lanes == 1 && levels == Levels::one,
                                    LaneGather<Law, Real>, WarpGather<Law, Real, lanes, levels>>;

// Warps are independent: none waits for another one of its block.
template <class Step, std::uint32_t lanes, Levels levels>
__global__ void __launch_bounds__(step_block_threads, step_blocks<typename Step::Law>)
    step_kernel(const __grid_constant__ Step step, std::uint32_t rows, unsigned side) {
  using Gather = GatherOf<typename Step::Law, typename Step::Real, lanes, levels>;
  __shared__ BlockTally tallies[step_block_threads / 32];
  __shared__ typename Gather::Space spaces[step_block_threads / 32];
  WindowProgress& window = *step.view.window;
  const StepProgress progress = next_step(window, side);
  // Every warp has its own copy; one of them stores it for the next step.
  if (blockIdx.x == 0 && threadIdx.x == 0) window.progress[side ^ 1] = progress;
  if (progress.open == 0) return wait_for_kernel_before();

  BlockTally& of_warp = tallies[threadIdx.x / 32];
  if (Gather::thread() == 0) of_warp = {0, 0, 0, ~0u, 0, 0};
  __syncwarp();
  const CurrentStep now(window, progress);
  MotionTally tally{&of_warp, step.view.load + std::size_t{now.step} * rows * 6};
  const Range owned = step.view.spheres.owned;
  const std::uint32_t i = owned.begin + (blockIdx.x * blockDim.x + threadIdx.x) / lanes,
                      last = owned.end > 0 ? owned.end - 1 : 0;
  const Gather gather_pairs{spaces[threadIdx.x / 32]};
  const StateInMemory<typename Step::Real> state(step.view, now);
  if constexpr (has_fine_part<typename Step::Real>) prefetch(state.fine_parts + min(i, last));
  const ForceSum sum = gather_pairs(step.pairs(now, state), i, tally);
  const auto motion = step.motion(now, state);
  const auto own = motion.own(min(i, last));
  // Spheres away from walls may move while the wall kernel runs: FinePart is the only state that is not
  // double buffered, and the wall kernel reads it for spheres near walls only.
  if (__any_sync(~0u, own.walls.begin < own.walls.end)) wait_for_kernel_before();
  if (i < owned.end && gather_pairs.moves()) {
    motion.translate(i, own, sum.force, tally);
    if constexpr (Step::Law::tangential) motion.rotate(i, own, sum.torque);
  }
  __syncwarp();
  gather(tally.speed2, tally.overlap_ratio, of_warp);
  __syncwarp();
  if (Gather::thread() == 0) report(of_warp, window, side);
  // A kernel that waits for this one relies on the wall kernel to have ended, too.
  wait_for_kernel_before();
}

}  // namespace tandem::dem
