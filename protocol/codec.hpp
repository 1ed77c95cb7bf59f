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

void encode(Bytes& out, const Hello& value);
void encode(Bytes& out, const Failure& value);
void encode(Bytes& out, const Configuration& value);
void encode(Bytes& out, const Configured& value);
void encode(Bytes& out, const Window& value);
void encode(Bytes& out, const MotionSet& value);
void encode(Bytes& out, const LoadSet& value);
void encode(Bytes& out, const TangentSet& value);
void encode(Bytes& out, const ControlSet& value);
void encode(Bytes& out, const Checkpoint& value);
void encode(Bytes& out, Nanoseconds value);
void encode(Bytes& out, const BodiesFrame& value);
void encode(Bytes& out, const ParticlesFrame& value);
void encode(Bytes& out, const Report& value);

void decode(std::span<const std::byte> in, Hello& value);
void decode(std::span<const std::byte> in, Failure& value);
void decode(std::span<const std::byte> in, Configuration& value);
void decode(std::span<const std::byte> in, Configured& value);
void decode(std::span<const std::byte> in, Window& value);
void decode(std::span<const std::byte> in, MotionSet& value);
void decode(std::span<const std::byte> in, LoadSet& value);
void decode(std::span<const std::byte> in, TangentSet& value);
void decode(std::span<const std::byte> in, ControlSet& value);
void decode(std::span<const std::byte> in, Checkpoint& value);
void decode(std::span<const std::byte> in, Nanoseconds& value);
void decode(std::span<const std::byte> in, BodiesFrame& value);
void decode(std::span<const std::byte> in, ParticlesFrame& value);
void decode(std::span<const std::byte> in, Report& value);
// Payload size of a ParticlesFrame with that number of spheres [bytes].
std::uint64_t size_of_particles_frame(std::uint64_t spheres, bool with_contacts = false);

// save, restore, done, finish and welcome have an empty payload.
void decode_nothing(std::span<const std::byte> in);

}  // namespace tandem::protocol
