// May this participant take part? Compared are role, version, layout hash and capabilities.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "protocol/layout.hpp"
#include "protocol/messages.hpp"
#include "protocol/version.hpp"

namespace tandem::protocol {

// A version that this program speaks, and the layout that it has there.
struct Dialect {
  Version version;
  std::uint64_t layout_hash = 0;
};
// Newest first. A new minor goes in front and leaves the one before in the list.
inline constexpr Dialect dialects[] = {{protocol_version, layout_hash}, {{1, 3}, 0xd8c5d5cdce7ee812}};

// What every participant of this role can do; a solver adds what it can do besides.
std::uint64_t capabilities_of(Role role);

// The version to speak with a participant that speaks `version` and said `hello`; throws ProtocolError that
// names peer, field, both values and the remedy.
Version admit(const Hello& hello, Version version, Role role, std::uint64_t needed, const std::string& peer,
              std::span<const Dialect> spoken = dialects);

}  // namespace tandem::protocol
