// How an end of a local channel waits for the other: spin for a short while, then sleep.
#pragma once

namespace tandem::protocol {

enum class WaitPolicy {
  adaptive,  // spin as long as it has paid off lately and cores are free, then sleep
  spin,      // never sleep: lowest latency, one core per end
  block,     // sleep at once
};

}  // namespace tandem::protocol
