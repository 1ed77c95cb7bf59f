// The threads that share the work on one sphere. A CPU uses one thread, and so does a GPU with very many
// spheres. With few spheres a GPU uses a warp (backend/cuda/warp_group.cuh), whose threads divide up the
// sequence of one thread; counts and numbers below follow that sequence.
#pragma once

#include <cstdint>

#include "common/host_device.hpp"

namespace tandem::particles {

// The numbers [begin, end), with a note that applies to all of them.
struct Run {
  std::uint32_t begin = 0, end = 0;
  std::uint32_t note = 0;
};

struct OneThread {
  // Calls each(k, note, exists) for the numbers k of all runs. All threads of a group call it together, also
  // for numbers that do not exist.
  //
  // Two runs share a loop, so that GPU threads with one sphere each wait less for one another.
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
  // Over the threads that call it together: the number of those with `yes`, and the number of those before
  // this one.
  TANDEM_HD std::uint32_t count(bool yes) const { return yes ? 1 : 0; }
  TANDEM_HD std::uint32_t before(bool) const { return 0; }
};

}  // namespace tandem::particles
