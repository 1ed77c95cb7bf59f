// The runs of this user on this host: a folder of links to the folders of runs, one per run.
#pragma once

#include <filesystem>
#include <vector>

#include "coordinator/run_folder/run_state.hpp"

namespace tandem::launch {

// TANDEM_RUNS of the environment, or /tmp/tandem-UID where that is not set. Empty where the folder belongs to
// another user, or cannot be created.
std::filesystem::path registry_folder();

// The entry of this process's run. A run works without a registry, and then has no entry.
class RegistryEntry {
 public:
  explicit RegistryEntry(const std::filesystem::path& run_folder);
  ~RegistryEntry();
  RegistryEntry(const RegistryEntry&) = delete;
  RegistryEntry& operator=(const RegistryEntry&) = delete;

 private:
  std::filesystem::path link_;  // empty: none
};

struct RegisteredRun {
  std::int64_t pid = 0;
  std::uint64_t started = 0;  // of the process [clock ticks since the host's boot]
  std::filesystem::path folder;
  RunState state;
};
// Runs in progress and runs that died, by their start. Entries are removed if their folder is gone, or
// belongs to another run.
std::vector<RegisteredRun> registered_runs();
// Removes the entries of runs that died; their folders stay. Returns their number.
int forget_died_runs();

}  // namespace tandem::launch
