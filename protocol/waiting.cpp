#include "protocol/waiting.hpp"

#include <algorithm>

#include "common/cores.hpp"

namespace tandem::protocol {
namespace {

using namespace std::chrono_literals;

// Cost of sleeping and waking up, 40 us on a virtual machine: with less, two ends that both sleep would never
// find out that spinning is faster. With a core for each of the three programs and one to spare, far longer:
// an idle core takes 100 us and more to wake up.
Clock::duration spin_limit(WaitPolicy policy) {
  if (policy == WaitPolicy::block) return 0us;
  const unsigned usable = usable_cores();
  if (usable == 1) return 0us;  // a spinning end would prevent the other from running
  return usable < cores_to_spin ? Clock::duration(50us) : Clock::duration(20ms);
}

}  // namespace

Spinner::Spinner(WaitPolicy policy) : policy_(policy), limit_(spin_limit(policy)), budget_(limit_) {}

void Spinner::learn(Clock::duration waited) {
  budget_ = waited <= limit_ ? limit_ : std::max(limit_ / 16, budget_ / 2);
}

}  // namespace tandem::protocol
