// The threads that share the work on one sphere. A CPU has one, a GPU a warp (core/warp_group.cuh), whose
// threads take in turn what one thread would do one after the other: what is counted and numbered below has
// the order of that.
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
  template <class RunOf, class Each>
  void for_each(std::uint32_t runs, RunOf run_of, Each each) const {
    for (std::uint32_t r = 0; r < runs; ++r) {
      const Run run = run_of(r);
      for (std::uint32_t k = run.begin; k < run.end; ++k) each(k, run.note, true);
    }
  }
  bool first() const { return true; }
  // Of the threads that call it together: how many say yes, and how many of those come before this one.
  std::uint32_t count(bool yes) const { return yes ? 1 : 0; }
  std::uint32_t before(bool) const { return 0; }
};

}  // namespace tandem::dem
