// Decides whether a participant may take part, by role, version, layout hash and capabilities.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "protocol/layout.hpp"
#include "protocol/messages.hpp"
#include "protocol/version.hpp"

namespace tandem::protocol {

// A version that this program supports, and the layout in that version.
struct Dialect {
  Version version;
  std::uint64_t layout_hash = 0;
};
// Newest first. A new minor version is added in front, and those before stay in the list while they cost
// nothing.
inline constexpr Dialect dialects[] = {
    {protocol_version, layout_hash}, {{1, 4}, 0x82142f4fa4d5c467}, {{1, 3}, 0x6da5c5873d6d05de}};

// Capabilities with which a participant of this role runs the schemes `parallel`, `mbd_first`, `dem_first`
// and `implicit`: the default of a solver (participant/solver.hpp). A coordinator relies on none of them.
std::uint64_t capabilities_of(Role role);
// "1.5, 1.4 and 1.3".
std::string versions_of(std::span<const Dialect> spoken = dialects);
// "can_predict, can_rollback"; "none" for no bit.
std::string capability_names(std::uint64_t capabilities);

// Returns the version for the session with a participant of `version` that sent `hello`; throws ProtocolError
// with peer, field, both values and the remedy.
Version admit(const Hello& hello, Version version, Role role, std::uint64_t needed, const std::string& peer,
              std::span<const Dialect> spoken = dialects);

}  // namespace tandem::protocol
