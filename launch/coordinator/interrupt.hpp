// Ctrl-C, SIGTERM and SIGHUP (the terminal was closed): the first one stops the run after the current window;
// a second Ctrl-C or SIGTERM ends the program at once. A closed terminal may send SIGHUP twice, so that a
// second SIGHUP has no effect.
#pragma once

namespace tandem::launch {

class InterruptGuard {
 public:
  InterruptGuard();   // installs the handlers; an ignored SIGHUP (nohup) stays ignored
  ~InterruptGuard();  // restores the previous handlers
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

// True after the first of them, while there is a guard.
bool interrupted();

}  // namespace tandem::launch
