// A warp as the group of threads that share the work on one sphere (base/group.hpp).
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "particles/base/group.hpp"

namespace tandem::particles {

struct WarpGroup {
  static constexpr unsigned size = 32;

  // Distributes the numbers of all runs evenly over the threads, regardless of the run that they belong to.
  template <class RunOf, class Each>
  __device__ void for_each(std::uint32_t runs, RunOf run_of, Each each) const {
    for (std::uint32_t first = 0; first < runs; first += size)
      for_each_of(first + rank() < runs ? run_of(first + rank()) : Run{}, each);
  }
  __device__ bool first() const { return rank() == 0; }
  __device__ std::uint32_t count(bool yes) const {
    return static_cast<std::uint32_t>(__popc(__ballot_sync(~0u, yes)));
  }
  __device__ std::uint32_t before(bool yes) const {
    std::uint32_t all = 0;
    return before(yes, all);
  }
  // all: the number of those with `yes`.
  __device__ std::uint32_t before(bool yes, std::uint32_t& all) const {
    const unsigned votes = __ballot_sync(~0u, yes);
    all = static_cast<std::uint32_t>(__popc(votes));
    return static_cast<std::uint32_t>(__popc(votes & ((1u << rank()) - 1)));
  }

 private:
  // The same for 32 runs, one held by each thread.
  template <class Each>
  __device__ static void for_each_of(const Run& mine, Each& each) {
    const std::uint32_t length = mine.end - mine.begin;
    std::uint32_t upto = length;  // numbers in this run and those before it
    for (unsigned distance = 1; distance < size; distance *= 2) {
      const std::uint32_t lower = __shfl_up_sync(~0u, upto, distance);
      if (rank() >= distance) upto += lower;
    }
    const std::uint32_t all = __shfl_sync(~0u, upto, size - 1), offset = mine.begin - (upto - length);
    for (std::uint32_t first = 0; first < all; first += size) {
      const std::uint32_t which = first + rank();
      unsigned run = 0;  // number of runs that end at `which` or before it
      for (unsigned step = size / 2; step > 0; step /= 2)
        if (__shfl_sync(~0u, upto, static_cast<int>(run + step - 1)) <= which) run += step;
      const std::uint32_t k = __shfl_sync(~0u, offset, static_cast<int>(run)) + which;
      const std::uint32_t note = __shfl_sync(~0u, mine.note, static_cast<int>(run));
      each(which < all ? k : mine.begin, note, which < all);
    }
  }
  __device__ static unsigned rank() { return threadIdx.x % size; }
};

template <class F>
__global__ void for_each_shared_kernel(std::uint32_t n, F f) {
  const std::uint32_t i = (blockIdx.x * blockDim.x + threadIdx.x) / WarpGroup::size;
  if (i < n) f(i, WarpGroup{});
}

// One thread does the work on one sphere. Spheres that search a long range are processed by the whole warp,
// one after the other.
template <class F>
__global__ void for_each_alone_kernel(std::uint32_t n, F f) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if constexpr (requires { f.looks_far(i); }) {
    const bool far = i < n && f.looks_far(i);
    if (i < n && !far) f(i, OneThread{});
    for (unsigned left = __ballot_sync(~0u, far); left != 0; left &= left - 1)
      f(i - threadIdx.x % WarpGroup::size + static_cast<std::uint32_t>(__ffs(static_cast<int>(left))) - 1,
        WarpGroup{});
  } else {
    if (i < n) f(i, OneThread{});
  }
}

}  // namespace tandem::particles
