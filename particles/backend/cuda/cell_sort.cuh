// A counting sort in three passes, with a sum over the counts after the first one. The atomics of the first
// pass leave the order within a cell to chance; the last pass restores it, so that the sort is stable.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "particles/grid/index_order.hpp"

namespace tandem::particles {

template <class CellOf>
__global__ void count_cells_kernel(std::uint32_t n, CellOf cell_of, std::uint32_t* key, std::uint32_t* rank,
                                   std::uint32_t* count) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= n) return;
  key[i] = cell_of(i);
  rank[i] = atomicAdd(count + key[i], 1u);
}

struct ScatterToCells {
  const std::uint32_t *key, *rank, *start;
  std::uint32_t* source;
  __device__ void operator()(std::uint32_t i) const { source[start[key[i]] + rank[i]] = i; }
};
struct OrderInCells {
  const std::uint32_t *key, *unordered, *start;
  std::uint32_t* source;
  IndexOrder order;
  __device__ void operator()(std::uint32_t k) const {
    const std::uint32_t i = unordered[k], cell = key[i], begin = start[cell], end = start[cell + 1],
                        place = order.place(i);
    std::uint32_t at = begin;
    for (std::uint32_t other = begin; other < end; ++other)
      at += order.place(unordered[other]) < place ? 1 : 0;
    source[at] = i;
  }
};

}  // namespace tandem::particles
