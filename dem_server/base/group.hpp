// The threads that share the work on one sphere. A CPU has one, and so has a GPU with very many spheres; one
// with few spheres has a warp (backend/cuda/warp_group.cuh), whose threads take in turn what one thread would
// do one after the other: what is counted and numbered below has the order of that.
#pragma once

#include <cstdint>

#include "common/host_device.hpp"

namespace tandem::dem {

// The numbers [begin, end), and what goes with all of them.
struct Run {
  std::uint32_t begin = 0, end = 0;
  std::uint32_t note = 0;
};

struct OneThread {
  // Calls each(k, note, exists) for the numbers k of all runs. All threads of a group call it together, for
  // numbers that need not exist.
  //
  // Two runs share a loop: threads of a GPU that have a sphere each then wait less for one another.
  template <class RunOf, class Each>
  TANDEM_HD void for_each(std::uint32_t runs, RunOf run_of, Each each) const {
    for (std::uint32_t r = 0; r < runs; r += 2) {
      const Run one = run_of(r), two = r + 1 < runs ? run_of(r + 1) : Run{};
      const std::uint32_t of_one = one.end - one.begin, all = of_one + (two.end - two.begin);
      for (std::uint32_t k = 0; k < all; ++k) {
        const bool in_one = k < of_one;
        each(in_one ? one.begin + k : two.begin + (k - of_one), in_one ? one.note : two.note, true);
      }
    }
  }
  TANDEM_HD bool first() const { return true; }
  // Of the threads that call it together: how many say yes, and how many of those come before this one.
  TANDEM_HD std::uint32_t count(bool yes) const { return yes ? 1 : 0; }
  TANDEM_HD std::uint32_t before(bool) const { return 0; }
};

}  // namespace tandem::dem
