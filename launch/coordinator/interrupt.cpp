#include "launch/coordinator/interrupt.hpp"

#include <unistd.h>
#include <csignal>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

volatile std::sig_atomic_t signals_seen = 0;
struct sigaction previous_int, previous_term;

void on_signal(int) {
  // The servers notice that this process is gone and leave by themselves.
  if (signals_seen > 0) _exit(exit_status(ErrorCode::interrupted));
  signals_seen = signals_seen + 1;
}

}  // namespace

InterruptGuard::InterruptGuard() {
  signals_seen = 0;
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, &previous_int);
  sigaction(SIGTERM, &action, &previous_term);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &previous_int, nullptr);
  sigaction(SIGTERM, &previous_term, nullptr);
}

bool interrupted() {
  return signals_seen > 0;
}

}  // namespace tandem::launch
