#pragma once

#include <cstdint>

namespace tandem::protocol {

struct RunIdentity {
  std::uint64_t run_id = 0;
  // Counts the starts of one run, so that a server of an earlier start is refused.
  std::uint32_t generation = 0;
};

}  // namespace tandem::protocol
