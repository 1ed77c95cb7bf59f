// How blocks, and the threads of a block, wait for each other in the kernel of
// backend/cuda/resident/resident.cuh, and share out the registers.
#pragma once

#include <cuda_runtime.h>

#include "dem_server/backend/cuda/resident/regions.cuh"

namespace tandem::dem {

// All blocks meet: what one has written before, the others find in the second-level cache. Nothing is
// acquired on the way in: that would empty this multiprocessor's own cache, which holds what it alone uses,
// and load_uncached() does not look there. Where the others do not come within seconds, the device does not
// run all blocks at once, against what it said: an error.
__device__ inline MeetingPoint meet(MeetingPoint* at, unsigned expected) {
  asm volatile("red.release.gpu.global.add.u32 [%0], 1;" ::"l"(&at->arrived) : "memory");
  MeetingPoint seen;
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

// Barriers of the block, by number, and of those of its threads that have a task. Both tasks come to equally
// many in a step, although walls need but three: racecheck takes what happens before and after a barrier of
// the whole block for ordered only where all warps have come to as many barriers before it.
enum class Meet : unsigned { decision = 0, pairs = 1, forces = 2, walls = 3 };
template <Meet which>
__device__ void sync_block() {
  __syncwarp();  // a warp comes as a whole, or is counted more than once
  if constexpr (which == Meet::decision)
    asm volatile("bar.sync 0;" ::: "memory");
  else
    asm volatile("bar.sync %0, %1;" ::"n"(static_cast<unsigned>(which)),
                 "n"(which == Meet::pairs   ? pair_threads
                     : which == Meet::walls ? wall_threads
                                            : resident_threads)
                 : "memory");
}

// Takes registers of the multiprocessor for the warps of a task, or gives them back, where it can do that.
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
