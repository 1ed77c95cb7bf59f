// Runs scenes concurrently, each by its own `tandem run`: a crash of one does not affect the others.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace tandem::launch {

struct Job {
  std::filesystem::path scene, folder;  // input, results; the output of the run goes to FOLDER.log
  std::string backend;
  int threads = 1;
  double limit = 0;                    // longest wall time [s]
  std::vector<std::string> arguments;  // further ones of `tandem run`
};

// Begin of the last line of FOLDER.log of a job that took longer than its limit.
inline constexpr const char* stopped_at_limit = "stopped at the limit";

// Runs `side_by_side` jobs at a time, in order. Calls `done(i, seconds)` after job i, one call at a time.
// After an interrupt the runs end after their windows, and no further one starts.
void run_jobs(const std::vector<Job>& jobs, int side_by_side,
              const std::function<void(std::size_t, double)>& done);

}  // namespace tandem::launch
