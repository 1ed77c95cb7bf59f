// Payloads to bytes and back. encode() fills `out`, whose capacity is kept; decode() fills `value`, whose
// arrays keep their capacity: a steady exchange does not allocate. decode() accepts exactly the output of
// encode(), or throws ProtocolError {truncated, trailing_bytes, count_too_large}; checks.hpp checks the
// values.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "protocol/messages.hpp"

namespace tandem::protocol {

using Bytes = std::vector<std::byte>;

// For Hello, Failure and all other payloads of messages.hpp.
template <class Payload>
void encode(Bytes& out, const Payload& value);
template <class Payload>
void decode(std::span<const std::byte> in, Payload& value);

// Payload size of a ParticlesFrame with that number of spheres [bytes].
std::uint64_t size_of_particles_frame(std::uint64_t spheres, bool with_contacts = false);

// save, restore, done, finish and welcome have an empty payload.
void decode_nothing(std::span<const std::byte> in);

}  // namespace tandem::protocol
