#include "launch/coordinator/interrupt.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

// Two signals may be handled by two threads at once; lock-free atomics are allowed in handlers.
std::atomic<int> stop_requested = 0, hung_up = 0;
static_assert(std::atomic<int>::is_always_lock_free);
struct sigaction previous_int, previous_term, previous_hup;

void on_signal(int) {
  // The servers detect the end of this process and end as well.
  if (stop_requested > 0) _exit(exit_status(ErrorCode::interrupted));
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
}

}  // namespace

InterruptGuard::InterruptGuard() {
  stop_requested = 0;
  hung_up = 0;
  install(SIGINT, on_signal, previous_int);
  install(SIGTERM, on_signal, previous_term);
  install(SIGHUP, on_hangup, previous_hup);
  if (previous_hup.sa_handler == SIG_IGN) sigaction(SIGHUP, &previous_hup, nullptr);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &previous_int, nullptr);
  sigaction(SIGTERM, &previous_term, nullptr);
  sigaction(SIGHUP, &previous_hup, nullptr);
  stop_requested = 0;
  hung_up = 0;
}

bool interrupted() {
  return stop_requested > 0 || hung_up > 0;
}

}  // namespace tandem::launch
