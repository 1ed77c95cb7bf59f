// Ctrl-C, SIGTERM and SIGHUP (the terminal was closed): the first asks the run to stop after the current
// window; a second Ctrl-C or SIGTERM ends the program at once. A closed terminal may say so twice, so a
// SIGHUP never does.
#pragma once

namespace tandem::launch {

class InterruptGuard {
 public:
  InterruptGuard();   // installs the handlers; a SIGHUP that was ignored (nohup) stays so
  ~InterruptGuard();  // puts back what was there
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

// True after the first of them.
bool interrupted();

}  // namespace tandem::launch
