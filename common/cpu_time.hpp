// Processor time: the cost of a computation where other programs share the machine and wall time is no
// measure.
#pragma once

#include <ctime>

namespace tandem {

enum class CpuClock { thread, process };

// Processor time of the calling thread, or of all threads of this process [s].
inline double cpu_seconds(CpuClock clock) {
  timespec now{};
  clock_gettime(clock == CpuClock::thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace tandem
