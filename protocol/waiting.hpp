// How an end of a local channel waits for the other: spin for a short while, then sleep.
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

#include "protocol/channel.hpp"

namespace tandem::protocol {

enum class WaitPolicy {
  adaptive,  // spin as long as it was successful lately and cores are free, then sleep
  spin,      // never sleep: lowest latency, one core per end
  block,     // sleep at once
};

// Hints to the core that this is a spin loop.
inline void pause_core() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

// Decides how long to spin. Spinning for the duration of a wake-up takes at most twice the optimal time; once
// waits have become longer, most of it is saved. Where cores are free, spinning continues until another
// thread needs the core, or a wake-up is below one percent of the wait.
class Spinner {
 public:
  explicit Spinner(WaitPolicy policy);
  bool may_sleep() const { return policy_ != WaitPolicy::spin; }

  // Returns true as soon as ready(), false when the time for spinning is used up.
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
      // The other end, or a solver's thread, may need this core: it does if the last iteration took
      // long.
      if (may_sleep() && now - before > taken) break;
      std::this_thread::yield();
    }
    return ready();
  }
  // Reports the duration of a whole wait, sleep included.
  void learn(Clock::duration waited);

 private:
  // Time for which a spinning end keeps its core.
  static constexpr auto alone = std::chrono::microseconds(2);
  // An iteration takes a microsecond; a longer one shows that another thread ran on this core.
  static constexpr auto taken = std::chrono::microseconds(50);
  // Reading the clock costs as much as a few checks.
  static constexpr int looks_per_clock = 16;
  WaitPolicy policy_;
  Clock::duration limit_, budget_;
};

}  // namespace tandem::protocol
