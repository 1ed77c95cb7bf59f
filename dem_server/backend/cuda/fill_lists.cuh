// Fills the pair lists of very many spheres. Each thread finds the neighbours of one sphere and stores them
// in shared memory. The 32 lists of a warp are contiguous in global memory, so that its threads then write
// their entries with coalesced stores.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/backend/cuda/warp_group.cuh"
#include "particles/base/group.hpp"

namespace tandem::dem {

inline constexpr unsigned fill_threads = 128;

// A neighbour to be listed, and the sphere of the warp whose list it belongs to.
struct FoundNeighbour {
  std::uint32_t index;
  std::uint8_t sphere;
  Image image;
  bool touching;
};
static_assert(sizeof(FoundNeighbour) == 8);

// Entries that a warp has room for. Where its lists together are longer, the warp fills them one after the
// other.
inline constexpr std::uint32_t found_room = 512;

template <class Fill>
__global__ void __launch_bounds__(fill_threads) fill_lists_kernel(std::uint32_t n, Fill fill) {
  __shared__ FoundNeighbour spaces[fill_threads / 32][found_room];
  FoundNeighbour* const found = spaces[threadIdx.x / 32];
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x, lane = threadIdx.x % 32, first = i - lane,
                      last = first + 32 < n ? first + 32 : n;
  if (first >= n || !fill.fits()) return;
  const Range entries = fill.entries(first, last);
  if (entries.end - entries.begin > found_room) {
    for (std::uint32_t k = first; k < last; ++k) fill(k, WarpGroup{});
    return;
  }
  if (i < n)
    fill.find(i, OneThread{}, [&](std::uint32_t k, std::uint32_t j, Image image, bool touching) {
      found[k - entries.begin] = {j, static_cast<std::uint8_t>(lane), image, touching};
    });
  __syncwarp();
  for (std::uint32_t k = entries.begin + lane; k < entries.end; k += 32) {
    const FoundNeighbour& of = found[k - entries.begin];
    fill.write(first + of.sphere, k, of.index, of.image, of.touching);
  }
}

}  // namespace tandem::dem
