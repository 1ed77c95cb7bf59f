// Counts what operator new is asked for in this program.
#pragma once

#include <cstddef>

namespace tandem::protocol::test {
std::size_t allocations();
}
