#include "common/interrupt.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>

#include "common/error.hpp"

namespace tandem {
namespace {

// Two signals may be handled by two threads at once; lock-free atomics are allowed in handlers.
std::atomic<int> stop_requested = 0, hung_up = 0;
std::array<std::atomic<int>, 64> groups;  // 0: free
static_assert(std::atomic<int>::is_always_lock_free);
struct sigaction previous_int, previous_term, previous_hup;
int guards = 0;
std::atomic<int> starts = 0;  // StartGuards
std::atomic<bool> ends = false;

// The servers of tandem detect the end of this process, and end as well.
[[noreturn]] void end_now() {
  for (const std::atomic<int>& group : groups)
    if (const int number = group; number > 0) kill(-number, SIGKILL);
  _exit(exit_status(ErrorCode::interrupted));
}

// Whichever comes last, the signal or the end of the start, sees the other.
void end_at_once() {
  ends = true;
  if (starts == 0) end_now();
}

void on_first_signal(int) {
  constexpr char said[] = "error: interrupted\n";
  // Nothing can be done where standard error is closed.
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, said, sizeof said - 1);
  end_at_once();
}

void on_signal(int) {
  if (stop_requested > 0) end_at_once();
  stop_requested = 1;
}

void on_hangup(int) {
  hung_up = 1;
}

void install(int signal, void (*handler)(int), struct sigaction& previous) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, &previous);
  if (signal == SIGHUP && previous.sa_handler == SIG_IGN) sigaction(SIGHUP, &previous, nullptr);
}

}  // namespace

void end_on_interrupt() {
  struct sigaction previous {};
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) install(signal, on_first_signal, previous);
}

InterruptGuard::InterruptGuard() {
  if (guards++ > 0) return;
  forget_interrupt();
  install(SIGINT, on_signal, previous_int);
  install(SIGTERM, on_signal, previous_term);
  install(SIGHUP, on_hangup, previous_hup);
}

InterruptGuard::~InterruptGuard() {
  if (--guards > 0) return;
  sigaction(SIGINT, &previous_int, nullptr);
  sigaction(SIGTERM, &previous_term, nullptr);
  sigaction(SIGHUP, &previous_hup, nullptr);
  forget_interrupt();
}

bool interrupted() {
  return stop_requested > 0 || hung_up > 0;
}

void forget_interrupt() {
  stop_requested = 0;
  hung_up = 0;
}

StartGuard::StartGuard() {
  ++starts;
}

StartGuard::~StartGuard() {
  if (--starts == 0 && ends) end_now();
}

void end_with_us(int group) {
  for (std::atomic<int>& place : groups)
    if (int free = 0; place.compare_exchange_strong(free, group)) return;
}

void outlives_us(int group) {
  for (std::atomic<int>& place : groups)
    if (int there = group; place.compare_exchange_strong(there, 0)) return;
}

}  // namespace tandem
