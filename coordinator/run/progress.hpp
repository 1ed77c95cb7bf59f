// One line on the progress of a run: rewritten on a terminal, every ten seconds elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "common/time.hpp"

namespace tandem::launch {

class Progress {
 public:
  // The run starts at `begin`, with the micro steps already taken.
  Progress(Nanoseconds begin, std::uint64_t micro_steps, Nanoseconds end, bool quiet);
  ~Progress();  // ends the rewritten line

  // `spheres`: number in the domain; 0 where it is unknown, so that sphere steps are not counted.
  void update(Nanoseconds now, std::uint64_t windows, std::uint64_t micro_steps, std::uint64_t spheres);
  // The text, at `elapsed` seconds of wall time after the begin.
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
