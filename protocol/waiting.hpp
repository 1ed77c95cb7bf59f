// How an end of a local channel waits for the other: spin for a short while, then sleep.
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

#include "protocol/channel.hpp"

namespace tandem::protocol {

enum class WaitPolicy {
  adaptive,  // spin as long as it has paid off lately and cores are there for it, then sleep
  spin,      // never sleep: lowest latency, one core per end
  block,     // sleep at once
};

// Tells the core that this is a spin loop.
inline void pause_core() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

// Decides how long to spin. Spinning for as long as a wake-up costs is at most twice as slow as knowing the
// future; once waits have turned out longer, most of it is saved. Where there are cores to spare, spinning
// goes on until somebody else wants the core, or a wake-up is below one percent of the wait.
class Spinner {
 public:
  explicit Spinner(WaitPolicy policy);
  bool may_sleep() const { return policy_ != WaitPolicy::spin; }

  // True as soon as ready(), false when the time for spinning is used up.
  template <class Ready>
  bool spin(const Ready& ready, Clock::time_point now, Deadline deadline) const {
    const Deadline end = may_sleep() ? std::min(deadline, now + budget_) : deadline;
    const Clock::time_point polite = now + alone;
    if (ready()) return true;
    for (Clock::time_point before = now; now < end; before = now, now = Clock::now()) {
      for (int i = 0; i < looks_per_clock; ++i) {
        if (ready()) return true;
        pause_core();
      }
      if (now <= polite) continue;
      // The other end, or a solver's thread, may be waiting for this very core: it was if the last turn took
      // long.
      if (may_sleep() && now - before > taken) break;
      std::this_thread::yield();
    }
    return ready();
  }
  // What a whole wait took, sleep included.
  void learn(Clock::duration waited);

 private:
  // For so long a spinning end keeps its core to itself.
  static constexpr auto alone = std::chrono::microseconds(2);
  // A turn of the loop takes a microsecond; a longer one says that somebody else ran in it.
  static constexpr auto taken = std::chrono::microseconds(50);
  // Reading the clock costs as much as a few looks.
  static constexpr int looks_per_clock = 16;
  WaitPolicy policy_;
  Clock::duration limit_, budget_;
};

}  // namespace tandem::protocol
