// What distinguishes the back ends for those who lay out their memory.
#pragma once

#include <cstddef>

namespace tandem::dem {

struct CpuTraits {
  static constexpr bool on_host = true;         // its buffers are memory of the host
  static constexpr bool pairs_once = true;      // a pair is evaluated once, not from both sides
  static constexpr std::size_t read_ahead = 0;  // entries of a list that may be read beyond its end
};

struct CudaTraits {
  static constexpr bool on_host = false;
  static constexpr bool pairs_once = false;
  static constexpr std::size_t read_ahead = 32;
};

}  // namespace tandem::dem
