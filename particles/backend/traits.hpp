// The properties of a back end on which the layout of its memory depends.
#pragma once

#include <cstddef>

namespace tandem::particles {

struct CpuTraits {
  static constexpr bool on_host = true;         // buffers are memory of the host
  static constexpr bool pairs_once = true;      // a pair is evaluated once, not from both sides
  static constexpr std::size_t read_ahead = 0;  // entries that a kernel may read beyond the end of a list
};

struct CudaTraits {
  static constexpr bool on_host = false;
  static constexpr bool pairs_once = false;
  static constexpr std::size_t read_ahead = 32;
};

}  // namespace tandem::particles
