// Ctrl-C, SIGTERM and SIGHUP (the terminal was closed).
#pragma once

namespace tandem {

// From now on each of them ends the program at once with exit status 130, while there is no InterruptGuard;
// also where the program was started with SIGINT ignored, as scripts do with what they start by `&`. An
// ignored SIGHUP (nohup) stays ignored.
void end_on_interrupt();

// While there is one, the first of them only sets interrupted(): a run ends after its window. A second Ctrl-C
// or SIGTERM ends the program at once. A closed terminal may send SIGHUP twice, so that a second SIGHUP has
// no effect. Guards may be nested: the outermost one counts. For one thread at a time.
class InterruptGuard {
 public:
  InterruptGuard();   // an ignored SIGHUP stays ignored
  ~InterruptGuard();  // restores the previous handlers
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

// True after the first of them, while there is a guard.
bool interrupted();
// What was interrupted has ended in order: the next signal counts as the first.
void forget_interrupt();

// While a program is started: a signal that ends this one at once waits for end_with_us(), so that it leaves
// no program behind.
class StartGuard {
 public:
  StartGuard();
  ~StartGuard();
  StartGuard(const StartGuard&) = delete;
  StartGuard& operator=(const StartGuard&) = delete;
};

// The process group of a program that may not notice the end of this one: it is killed where a signal ends
// this program at once. Of more than 64 at a time, the last ones are not.
void end_with_us(int group);
void outlives_us(int group);  // or has ended

}  // namespace tandem
