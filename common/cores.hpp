// Number of processor cores available to this process.
#pragma once

#include <filesystem>

namespace tandem {

// Cores that the process may run on (affinity), and at most those that its control groups allow; at least 1.
unsigned usable_cores();

// Processor time that the control groups (version 2) in the file system below `root` allow a process, in
// whole cores, rounded up; 0: no limit.
unsigned cores_of_groups(const std::filesystem::path& root);

// With this number of cores the programs of a run that wait for each other stay on separate cores
// (protocol/waiting.cpp).
inline constexpr unsigned cores_to_spin = 4;

}  // namespace tandem
