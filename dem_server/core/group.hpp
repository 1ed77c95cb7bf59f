// The threads that share the work on one sphere. A CPU has one, a GPU several of a warp (exec_cuda.cuh),
// which then do parts of what one would do in turn; in the order of their ranks the parts are in the same
// order.
#pragma once

#include <cstdint>

namespace tandem::dem {

struct Share {
  std::uint32_t begin, end;
};

struct OneThread {
  static constexpr bool alone = true;
  Share share(std::uint32_t count) const { return {0, count}; }
  bool first() const { return true; }
  std::uint32_t sum(std::uint32_t mine) const { return mine; }
  std::uint32_t of_lower(std::uint32_t) const { return 0; }  // sum of what those of lower rank give
};

}  // namespace tandem::dem
