#include "protocol/waiting.hpp"

#include <sched.h>

#include <algorithm>

namespace tandem::protocol {
namespace {

using namespace std::chrono_literals;

// What sleeping and being woken costs, 40 us on a virtual machine: less, and two ends that both sleep would
// never find out that spinning pays.
Clock::duration spin_limit(WaitPolicy policy) {
  if (policy == WaitPolicy::block) return 0us;
  cpu_set_t cores;
  const int usable = sched_getaffinity(0, sizeof cores, &cores) == 0 ? CPU_COUNT(&cores) : 1;
  return usable == 1 ? 0us : 50us;  // alone, a spinning end would keep the other from running
}

}  // namespace

Spinner::Spinner(WaitPolicy policy) : policy_(policy), limit_(spin_limit(policy)), budget_(limit_) {}

void Spinner::learn(Clock::duration waited) {
  budget_ = waited <= limit_ ? limit_ : std::max(limit_ / 16, budget_ / 2);
}

}  // namespace tandem::protocol
