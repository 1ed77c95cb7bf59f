#include "launch/study/jobs.hpp"

#include <atomic>
#include <cmath>
#include <exception>
#include <fstream>
#include <mutex>
#include <thread>

#include "common/error.hpp"
#include "common/interrupt.hpp"
#include "coordinator/report/tool.hpp"

namespace tandem::launch {
namespace {

void run(const Job& job) {
  Tool tool{.program = std::filesystem::read_symlink("/proc/self/exe").string(),
            .package = "tandem",
            .arguments = {"run", std::filesystem::absolute(job.scene).string(), "--out",
                          std::filesystem::absolute(job.folder).string(), "--backend", job.backend,
                          "--threads", std::to_string(job.threads), "--no-picture", "--no-report", "--quiet"},
            .folder = ".",
            .log = std::filesystem::absolute(job.folder).string() + ".log",
            .patience = std::chrono::seconds(std::llround(std::ceil(job.limit))),
            .ends_in_order = true};
  tool.arguments.insert(tool.arguments.end(), job.arguments.begin(), job.arguments.end());
  const ToolEnd end = wait_for_tool(tool);
  if (!end.started) throw Error(ErrorCode::resource, "a run could not be started", tool.program);
  // A run that was killed could not write the reason.
  std::ofstream log(tool.log, std::ios::app);
  if (end.timed_out)
    log << stopped_at_limit << " of " << job.limit << " s\n";
  else if (end.signal != 0)
    log << "ended by signal " << end.signal << '\n';
}

}  // namespace

void run_jobs(const std::vector<Job>& jobs, int side_by_side,
              const std::function<void(std::size_t, double)>& done) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t i; !interrupted() && (i = next++) < jobs.size();) {
      const auto begin = std::chrono::steady_clock::now();
      try {
        run(jobs[i]);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
        const std::lock_guard lock(mutex);
        done(i, seconds.count());
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = jobs.size();
      }
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < side_by_side; ++i) workers.emplace_back(work);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace tandem::launch
