// An order of indices in which some come before all lower ones.
#pragma once

#include <cstdint>

#include "common/host_device.hpp"

namespace tandem::particles {

// Indices first to first + count - 1 come first, then those below `first`, then the rest. By default each
// index comes after all lower ones.
struct IndexOrder {
  std::uint32_t first = 0, count = 0;

  TANDEM_HD std::uint32_t place(std::uint32_t index) const {
    if (index >= first + count) return index;
    return index < first ? index + count : index - first;
  }
  TANDEM_HD std::uint32_t index(std::uint32_t place) const {
    if (place >= first + count) return place;
    return place < count ? place + first : place - count;
  }
};

}  // namespace tandem::particles
