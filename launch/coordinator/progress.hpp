// One line that tells how far a run is: rewritten on a terminal, every ten seconds elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "common/time.hpp"

namespace tandem::launch {

class Progress {
 public:
  // The run goes on from `begin` and after so many micro steps. `spheres` may be 0: then only windows are
  // counted.
  Progress(Nanoseconds begin, std::uint64_t micro_steps, Nanoseconds end, std::uint64_t spheres, bool quiet);
  ~Progress();  // ends the rewritten line

  void update(Nanoseconds now, std::uint64_t windows, std::uint64_t micro_steps);

 private:
  using Clock = std::chrono::steady_clock;
  std::string line(Nanoseconds now, std::uint64_t windows, std::uint64_t micro_steps, double elapsed) const;

  Nanoseconds start_, end_;
  std::uint64_t steps_before_;
  std::uint64_t spheres_;
  bool quiet_, terminal_, written_ = false;
  Clock::time_point begin_, last_;
};

}  // namespace tandem::launch
