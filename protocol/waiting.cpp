#include "protocol/waiting.hpp"

#include <sched.h>

#include <algorithm>

namespace tandem::protocol {
namespace {

using namespace std::chrono_literals;

// The other end, and the solver's threads, need cores too: where there are few, a spinning end soon gives
// way.
Clock::duration spin_limit(WaitPolicy policy) {
  if (policy == WaitPolicy::block) return 0us;
  cpu_set_t cores;
  const int usable = sched_getaffinity(0, sizeof cores, &cores) == 0 ? CPU_COUNT(&cores) : 1;
  if (usable == 1) return 0us;
  return usable == 2 ? 10us : 50us;
}

}  // namespace

Spinner::Spinner(WaitPolicy policy) : policy_(policy), limit_(spin_limit(policy)), budget_(limit_) {}

void Spinner::learn(Clock::duration waited) {
  budget_ = waited <= limit_ ? limit_ : std::max(limit_ / 16, budget_ / 2);
}

}  // namespace tandem::protocol
