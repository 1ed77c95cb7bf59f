// The stack of the programs: what is recursive needs some of it, and without it a program ends by a signal.
#pragma once

#include <cstdint>

namespace tandem {

inline constexpr std::uint64_t least_stack = 1 << 20;  // [bytes]

// Throws Error{resource} where the limit of the system is below that (`ulimit -s`).
void expect_stack();

}  // namespace tandem
