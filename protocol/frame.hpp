// A frame on the wire: a header of 64 bytes, then the payload. Little-endian, no padding.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

#include "protocol/messages.hpp"
#include "protocol/version.hpp"

namespace tandem::protocol {

static_assert(std::endian::native == std::endian::little, "records are copied to the wire as they stand");

inline constexpr std::uint32_t frame_magic = 0x4d444e54;  // "TNDM"
// A larger size indicates a damaged header.
inline constexpr std::uint64_t max_payload = std::uint64_t{1} << 32;

struct FrameHeader {
  std::uint32_t magic = frame_magic;
  Version version = protocol_version;  // magic and version keep their place in all future versions
  Kind kind{};
  std::uint16_t reserved = 0;
  std::uint32_t generation = 0;    // of the run; 0 until welcome
  std::uint64_t run_id = 0;        // 0 until welcome
  std::uint64_t window = 0;        // index of the window that the frame belongs to
  std::uint64_t sequence = 0;      // counts the frames of one direction from 1
  std::uint64_t payload_size = 0;  // [bytes]
  std::uint32_t iteration = 0;     // attempt at this window, from 0: number of restores
  std::uint32_t flags = 0;         // unused
  std::uint64_t checksum = 0;      // of the header with checksum 0, then of the payload
};
static_assert(sizeof(FrameHeader) == 64 && alignof(FrameHeader) == 8);
static_assert(std::is_trivially_copyable_v<FrameHeader> &&
              std::has_unique_object_representations_v<FrameHeader>);
static_assert(offsetof(FrameHeader, version) == 4 && offsetof(FrameHeader, kind) == 8 &&
              offsetof(FrameHeader, generation) == 12 && offsetof(FrameHeader, run_id) == 16 &&
              offsetof(FrameHeader, window) == 24 && offsetof(FrameHeader, sequence) == 32 &&
              offsetof(FrameHeader, payload_size) == 40 && offsetof(FrameHeader, iteration) == 48 &&
              offsetof(FrameHeader, flags) == 52 && offsetof(FrameHeader, checksum) == 56);

// 64-bit hash that detects damage (not an attacker); continues from `seed`.
std::uint64_t checksum(std::span<const std::byte> data, std::uint64_t seed = 0);

// Sets payload_size and checksum.
void seal(FrameHeader& header, std::span<const std::byte> payload);

// The header of a received frame, after checking magic, major version, size and checksum. `where` names peer
// and channel in errors. The session checks the minor version.
FrameHeader open_frame(std::span<const std::byte> frame, const std::string& where);

inline std::span<const std::byte> payload_of(std::span<const std::byte> frame) {
  return frame.subspan(sizeof(FrameHeader));
}

}  // namespace tandem::protocol
