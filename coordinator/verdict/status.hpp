// The status of a run: the values of `status` in summary.json (docs/verdict.md), defined here only.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace tandem::launch {

enum class Status {
  running,  // the summary is that of the start; the run is in progress
  ok,       // it completed, and no rule of the verdict objects
  suspect,  // it completed, and a rule of the verdict objects to a figure
  failed,   // a check failed, the run was interrupted, or an error ended it: `reason` gives which
  died,     // the summary says `running`, but the process that wrote it is gone; only readers set this
};
const char* name(Status status);

// `reason` of a failed run: one of these, or the code name of the error that ended it.
inline constexpr const char* reason_checks = "checks";
inline constexpr const char* reason_interrupted = "interrupted";

// Host, number and start of this process, by which a reader determines whether it is still running.
nlohmann::ordered_json this_process();

// Start of a process of this host since the host's boot [clock ticks]; 0 where no such process is running. It
// distinguishes a process from a later one with the same number.
std::uint64_t process_start(long pid);

bool is_of_this_host(const nlohmann::json& summary);

// The status of a run by its summary.json alone: `died` in place of `running` where the process that wrote it
// ran on this host and is gone. Empty where the summary has no status. read_run() of
// coordinator/run_folder/run_state.hpp uses the marker as well.
std::string status_now(const nlohmann::json& summary);

}  // namespace tandem::launch
