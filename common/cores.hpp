// How many processor cores there are for this process.
#pragma once

#include <filesystem>

namespace tandem {

// Those that it may run on (affinity), and no more than its control groups have time for; at least 1.
unsigned usable_cores();

// Whole cores of which the control groups (version 2) in the file system below `root` let a process have the
// time, rounded up; 0: no limit.
unsigned cores_of_groups(const std::filesystem::path& root);

// With so many the programs of a run that wait for each other stay on cores of their own
// (protocol/waiting.cpp).
inline constexpr unsigned cores_to_spin = 4;

}  // namespace tandem
