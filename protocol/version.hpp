// Version of the protocol. Same major version: same header and rules. A new minor version only appends
// messages and capability bits, so that a coordinator serves participants of its own minor version and of the
// one before.
#pragma once

#include <cstdint>

namespace tandem::protocol {

struct Version {
  std::uint16_t major = 0, minor = 0;
  friend constexpr bool operator==(Version, Version) = default;
};

inline constexpr Version protocol_version{1, 5};

}  // namespace tandem::protocol
