// Limits of the system for the programs: what is recursive needs some stack, and without it a program ends by
// a signal.
#pragma once

#include <cstdint>

namespace tandem {

inline constexpr std::uint64_t least_stack = 1 << 20;  // [bytes]

// Throws Error{resource} where the limit of the system is below that (`ulimit -s`).
void expect_stack();

inline constexpr std::uint64_t least_open_files = 64;

// Raises the limit of open files to that of the system where it is low. Throws Error{resource} where that is
// too low as well (`ulimit -n`): programs and files would fail at any place, with other causes.
void expect_open_files();

}  // namespace tandem
