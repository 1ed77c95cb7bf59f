// Barriers of the grid and of parts of a block, and the distribution of registers, for the kernel of
// backend/cuda/resident/resident.cuh.
#pragma once

#include <cuda_runtime.h>

#include "dem_server/backend/cuda/resident/regions.cuh"

namespace tandem::dem {

// Waits until all blocks have arrived at the barrier. Data that a block has written before is then in the L2
// cache, where load_uncached() finds it. The wait has no acquire semantics: an acquire would invalidate the
// L1 cache, which holds data that only this multiprocessor uses. If the other blocks do not arrive within
// seconds, the device does not run all blocks at the same time, although it reported that it can: an error.
__device__ inline GridBarrier wait_for_all_blocks(GridBarrier* at, unsigned expected) {
  asm volatile("red.release.gpu.global.add.u32 [%0], 1;" ::"l"(&at->arrived) : "memory");
  GridBarrier seen;
  for (unsigned rolling = 1;; ++rolling) {
    asm volatile("ld.relaxed.gpu.global.v4.u32 {%0, %1, %2, %3}, [%4];"
                 : "=r"(seen.arrived), "=r"(seen.error), "=r"(seen.max_speed2[0]), "=r"(seen.max_speed2[1])
                 : "l"(at)
                 : "memory");
    if (seen.arrived >= expected) return seen;
    if (rolling % (1u << 22) != 0) continue;
    seen.error = blocks_apart | blocks_apart << 16;
    return seen;
  }
}

// Barriers, by number, of the whole block and of the threads of one task. Both tasks pass the same number of
// barriers in a step, although the wall task needs only three of them: racecheck treats accesses before and
// after a barrier of the whole block as ordered only where all warps have passed the same number of barriers.
enum class BlockBarrier : unsigned { decision = 0, pairs = 1, forces = 2, walls = 3 };
template <BlockBarrier which>
__device__ void sync_block() {
  __syncwarp();  // a warp must arrive as a whole, else it is counted more than once
  if constexpr (which == BlockBarrier::decision)
    asm volatile("bar.sync 0;" ::: "memory");
  else
    asm volatile("bar.sync %0, %1;" ::"n"(static_cast<unsigned>(which)),
                 "n"(which == BlockBarrier::pairs   ? pair_threads
                     : which == BlockBarrier::walls ? wall_threads
                                                    : resident_threads)
                 : "memory");
}

// Takes registers of the multiprocessor for the warps of a task, or gives them back, on devices that support
// it.
template <unsigned count, bool more>
__device__ void set_registers() {
#if defined(__CUDA_ARCH_FEAT_SM90_ALL)
  if constexpr (more)
    asm volatile("setmaxnreg.inc.sync.aligned.u32 %0;" ::"n"(count));
  else
    asm volatile("setmaxnreg.dec.sync.aligned.u32 %0;" ::"n"(count));
#endif
}

}  // namespace tandem::dem
