// Threads that work on one sphere together: a single one on a CPU, a few neighbours of a warp on a GPU. What
// a group computes does not depend on its size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "common/host_device.hpp"

namespace tandem::dem {

struct SerialGroup {
  static constexpr int size = 1;
  TANDEM_HD int lane() const { return 0; }
  TANDEM_HD bool leads() const { return true; }
  TANDEM_HD void sync() const {}
  // How many threads of the group have `mine` set; `before` counts those below this one.
  TANDEM_HD int count(bool mine, int& before) const {
    before = 0;
    return mine ? 1 : 0;
  }
  TANDEM_HD int from_leader(int value) const { return value; }
  // The first k in [begin, end) for which test(k), or end.
  template <class Test>
  TANDEM_HD std::uint32_t find(std::uint32_t begin, std::uint32_t end, Test test) const {
    while (begin < end && !test(begin)) ++begin;
    return begin;
  }
  // sum + part(0) + part(1) + ... + part(n - 1), in that order; n is at most `size` where that is above one.
  template <class Sum, class Part>
  TANDEM_HD void add_in_order(Sum& sum, int n, Part part) const {
    for (int k = 0; k < n; ++k) sum += part(k);
  }
};

#if defined(__CUDACC__)
struct WarpGroup {
  static constexpr int size = 8;
  unsigned mask = 0xffu << (threadIdx.x & 24u);

  __device__ int lane() const { return static_cast<int>(threadIdx.x & 7u); }
  __device__ bool leads() const { return lane() == 0; }
  __device__ void sync() const { __syncwarp(mask); }
  __device__ int count(bool mine, int& before) const {
    const unsigned set = __ballot_sync(mask, mine);
    before = __popc(set & ((1u << (threadIdx.x & 31u)) - 1));
    return __popc(set);
  }
  __device__ int from_leader(int value) const { return __shfl_sync(mask, value, 0, size); }
  template <class Test>
  __device__ std::uint32_t find(std::uint32_t begin, std::uint32_t end, Test test) const {
    for (; begin < end; begin += size) {
      const std::uint32_t k = begin + static_cast<std::uint32_t>(lane());
      const unsigned set = __ballot_sync(mask, k < end && test(k)) >> (threadIdx.x & 24u) & 0xffu;
      if (set != 0) return begin + static_cast<std::uint32_t>(__ffs(static_cast<int>(set))) - 1;
    }
    return end;
  }
  __device__ bool none(bool mine) const { return __ballot_sync(mask, mine) == 0; }
  // Do all threads that take part have the same value? Some do take part.
  __device__ bool same_where(bool takes_part, std::uint32_t value) const {
    const unsigned part = __ballot_sync(mask, takes_part);
    const std::uint32_t first = __shfl_sync(mask, value, __ffs(static_cast<int>(part)) - 1);
    return __ballot_sync(mask, takes_part && value != first) == 0;
  }
  // Has this thread the least key of those that take part? Of equal keys the first thread's counts.
  __device__ bool is_least(bool takes_part, double key) const {
    unsigned least = static_cast<unsigned>(lane());
    double value = takes_part ? key : infinity;
    for (int distance = 1; distance < size; distance *= 2) {
      const double other = __shfl_xor_sync(mask, value, distance);
      const unsigned other_lane = __shfl_xor_sync(mask, least, distance);
      if (other < value || (other == value && other_lane < least)) {
        value = other;
        least = other_lane;
      }
    }
    return least == static_cast<unsigned>(lane());
  }
  template <class Sum, class Part>
  __device__ void add_in_order(Sum& sum, int n, Part part) const {
    Sum mine{};
    if (lane() < n) mine = part(lane());
    for (int k = 0; k < n; ++k) sum += shuffled(mine, k);
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  // What thread `source` of the group has.
  template <class T>
  __device__ T shuffled(const T& value, int source) const {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
    T out;
    for (std::size_t k = 0; k < sizeof(T) / 4; ++k)
      reinterpret_cast<unsigned*>(&out)[k] =
          __shfl_sync(mask, reinterpret_cast<const unsigned*>(&value)[k], source, size);
    return out;
  }
};
#endif

}  // namespace tandem::dem
