#include "coordinator/run_folder/registry.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>

#include "coordinator/verdict/status.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

// Whether the folder belongs to this user, with no write access for others.
bool is_ours(const fs::path& folder) {
  struct stat facts {};
  return lstat(folder.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode) && facts.st_uid == geteuid() &&
         (facts.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

// "1234-56789": number and start of the process.
std::string entry_name(std::int64_t pid, std::uint64_t started) {
  return std::to_string(pid) + "-" + std::to_string(started);
}

struct Entry {
  fs::path link;
  RegisteredRun run;
};

std::vector<Entry> entries() {
  std::vector<Entry> found;
  const fs::path registry = registry_folder();
  std::error_code failure;
  if (registry.empty()) return found;
  for (const auto& entry : fs::directory_iterator(registry, failure)) {
    std::error_code unreadable;
    const fs::path folder = fs::read_symlink(entry.path(), unreadable);
    if (unreadable) continue;
    Entry one{entry.path(), {0, 0, folder, read_run(folder)}};
    const auto& marker = one.run.state.marker;
    // The run has ended, or its folder is gone or belongs to another run.
    if (!marker || marker->ended || entry_name(marker->pid, marker->started) != entry.path().filename()) {
      fs::remove(entry.path(), unreadable);
      continue;
    }
    one.run.pid = marker->pid;
    one.run.started = marker->started;
    found.push_back(std::move(one));
  }
  std::ranges::sort(found, {}, [](const Entry& entry) { return entry.run.started; });
  return found;
}

}  // namespace

fs::path registry_folder() {
  const char* given = std::getenv("TANDEM_RUNS");
  const fs::path folder = given != nullptr && *given != '\0'
                              ? fs::path(given)
                              : fs::path("/tmp") / ("tandem-" + std::to_string(geteuid()));
  mkdir(folder.c_str(), 0700);
  return is_ours(folder) ? folder : fs::path();
}

RegistryEntry::RegistryEntry(const fs::path& run_folder) {
  const fs::path registry = registry_folder();
  if (registry.empty()) return;
  const fs::path link = registry / entry_name(getpid(), process_start(getpid()));
  std::error_code failure;
  fs::remove(link, failure);  // of a previous run in the same process
  fs::create_symlink(fs::absolute(run_folder), link, failure);
  if (!failure) link_ = link;
}

RegistryEntry::~RegistryEntry() {
  std::error_code ignored;
  if (!link_.empty()) fs::remove(link_, ignored);
}

std::vector<RegisteredRun> registered_runs() {
  std::vector<RegisteredRun> runs;
  for (Entry& entry : entries()) runs.push_back(std::move(entry.run));
  return runs;
}

int forget_died_runs() {
  int count = 0;
  std::error_code ignored;
  for (const Entry& entry : entries())
    if (entry.run.state.status == name(Status::died) && fs::remove(entry.link, ignored)) ++count;
  return count;
}

}  // namespace tandem::launch
