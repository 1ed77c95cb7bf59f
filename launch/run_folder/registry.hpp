// The runs of this user on this host: a folder of links to the folders of runs, one per run.
#pragma once

#include <filesystem>
#include <vector>

#include "launch/run_folder/run_state.hpp"

namespace tandem::launch {

// $XDG_RUNTIME_DIR/tandem, or /tmp/tandem-UID where that is not set. Empty where it is not ours, or cannot be
// made.
std::filesystem::path registry_folder();

// The entry of this process's run. Without a registry there is none: a run needs none.
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
  std::filesystem::path folder;
  RunState state;
};
// Runs that go on and runs that died, by their start. Entries of folders that are gone, or that another run
// has taken since, are removed.
std::vector<RegisteredRun> registered_runs();
// Takes the entries of runs that died out of the registry; their folders stay. How many.
int forget_died_runs();

}  // namespace tandem::launch
