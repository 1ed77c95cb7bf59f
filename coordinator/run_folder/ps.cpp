#include "coordinator/run_folder/ps.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <thread>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "coordinator/run_folder/registry.hpp"
#include "coordinator/verdict/status.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double number(const nlohmann::json& summary, const char* key) {
  const auto found = summary.find(key);
  return found != summary.end() && found->is_number() ? found->get<double>() : 0;
}

std::string duration(double seconds) {
  const auto whole = static_cast<std::int64_t>(seconds);
  return whole < 60     ? fmt::format("{} s", whole)
         : whole < 3600 ? fmt::format("{} min {:02} s", whole / 60, whole % 60)
                        : fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

// Seconds since the start of a process of this boot.
double age(std::uint64_t started) {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) -
         static_cast<double>(started) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

// Wall time until the end of a run in progress, if it goes on as so far [s]; none before its first window.
std::optional<double> time_left(const RunState& state) {
  const double now = number(state.summary, "simulated_s"), wall = number(state.summary, "wall_s"),
               done = now - number(state.summary, "restarted_at_s"),
               rest = number(state.summary, "end_time_s") - now;
  if (state.status != name(Status::running) || !(done > 0) || !(wall > 0) || !(rest >= 0)) return {};
  return wall * rest / done;
}

bool goes_on(const RunState& state) {
  return state.marker && state.status == name(Status::running);
}

RegisteredRun find(const std::string& run) {
  const bool pid = !run.empty() && run.find_first_not_of("0123456789") == std::string::npos;
  for (RegisteredRun& one : registered_runs())
    if (goes_on(one.state) && pid && std::to_string(one.pid) == run) return one;
  // A folder need not be in the registry.
  RegisteredRun one{0, 0, run, read_run(run)};
  if (goes_on(one.state) && one.state.marker->host == own_marker({}).host) {
    one.pid = one.state.marker->pid;
    return one;
  }
  if (goes_on(one.state))
    throw Error(ErrorCode::usage, fmt::format("runs on {}", one.state.marker->host), run, "stop it there");
  throw Error(ErrorCode::usage, "no such run is in progress on this host", run,
              "give the pid or the folder of a run; tandem ps lists them");
}

}  // namespace

std::string list_of_runs() {
  const std::vector<RegisteredRun> runs = registered_runs();
  if (runs.empty()) return "no runs\n";
  std::string text = fmt::format("{:>8}  {:<8} {:>10}  {:>20}  {:>12}  {:>12}  {:<16} {}\n", "pid", "status",
                                 "window", "time [s]", "since", "left", "scene", "folder");
  for (const RegisteredRun& run : runs) {
    const auto& [marker, summary, status] = run.state;
    const std::optional<double> left = time_left(run.state);
    text += fmt::format(
        "{:>8}  {:<8} {:>10}  {:>20}  {:>12}  {:>12}  {:<16} {}\n", run.pid, status,
        number(summary, "windows"),
        fmt::format("{:.6g} of {:.6g}", number(summary, "simulated_s"), number(summary, "end_time_s")),
        status == name(Status::running) ? duration(age(marker->started)) : "-", left ? duration(*left) : "-",
        printable(marker->scene), printable(run.folder.string()));
  }
  return text;
}

std::string list_of_runs_as_json() {
  Json all = Json::array();
  for (const RegisteredRun& run : registered_runs()) {
    const auto& [marker, summary, status] = run.state;
    const std::optional<double> left = time_left(run.state);
    all.push_back({{"pid", run.pid},
                   {"status", status},
                   {"scene", marker->scene},
                   {"windows", number(summary, "windows")},
                   {"simulated_s", number(summary, "simulated_s")},
                   {"end_time_s", number(summary, "end_time_s")},
                   {"left_s", left ? Json(*left) : Json()},
                   {"folder", printable(run.folder.string())}});
  }
  return all.dump(2) + '\n';
}

void stop_run(const std::string& run, std::chrono::milliseconds patience) {
  const RegisteredRun found = find(run);
  const int process = static_cast<int>(syscall(SYS_pidfd_open, found.pid, 0));
  // Checked again with the process held open: its number may have been reused in between.
  const bool same = process >= 0 && process_start(found.pid) == found.state.marker->started;
  const bool sent = same && syscall(SYS_pidfd_send_signal, process, SIGTERM, nullptr, 0) == 0;
  const int error = errno;
  if (process >= 0) close(process);
  if (same && !sent)
    throw Error(ErrorCode::resource, "cannot be stopped: " + std::string(std::strerror(error)), run);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (goes_on(read_run(found.folder))) {
    if (std::chrono::steady_clock::now() > deadline)
      throw Error(ErrorCode::timeout,
                  fmt::format("still runs {:.3g} s after it was asked to stop",
                              std::chrono::duration<double>(patience).count()),
                  run, "wait for the end of its window, or ask again: a second time it ends at once");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace tandem::launch
