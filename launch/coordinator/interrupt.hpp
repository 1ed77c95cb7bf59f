// Ctrl-C and SIGTERM: the first asks the run to stop after the current window, the second ends the program at
// once.
#pragma once

namespace tandem::launch {

class InterruptGuard {
 public:
  InterruptGuard();   // installs the handlers
  ~InterruptGuard();  // puts back what was there
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

// True after the first signal.
bool interrupted();

}  // namespace tandem::launch
