// A range of indices.
#pragma once

#include <cstdint>

namespace tandem::particles {

// Numbers [begin, end).
struct Range {
  std::uint32_t begin = 0, end = 0;
};

}  // namespace tandem::particles
