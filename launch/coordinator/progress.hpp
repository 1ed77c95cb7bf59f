// One line that tells how far a run is: rewritten on a terminal, every ten seconds elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "common/time.hpp"

namespace tandem::launch {

class Progress {
 public:
  // The run goes on from `begin` and after so many micro steps.
  Progress(Nanoseconds begin, std::uint64_t micro_steps, Nanoseconds end, bool quiet);
  ~Progress();  // ends the rewritten line

  // `spheres` are those that are there; 0 where that is not known: then their steps are not counted.
  void update(Nanoseconds now, std::uint64_t windows, std::uint64_t micro_steps, std::uint64_t spheres);
  // The text, `elapsed` seconds of wall time after the begin.
  std::string line(Nanoseconds now, std::uint64_t windows, std::uint64_t micro_steps, std::uint64_t spheres,
                   double elapsed) const;

 private:
  using Clock = std::chrono::steady_clock;

  Nanoseconds start_, end_;
  std::uint64_t steps_before_;
  bool quiet_, terminal_, written_ = false;
  Clock::time_point begin_, last_;
};

}  // namespace tandem::launch
