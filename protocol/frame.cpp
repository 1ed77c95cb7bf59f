#include "protocol/frame.hpp"

#include <cstring>

#include "common/mix_word.hpp"
#include "protocol/violation.hpp"

namespace tandem::protocol {
namespace {

// Mixing of minor version 3 and before: the highest bits of a lane do not affect lower ones, and two changed
// words may cancel.
constexpr std::uint64_t mix_of_1_3(std::uint64_t lane, std::uint64_t word) {
  return std::rotl(lane ^ word, 29) * odd_0;
}

std::uint64_t load(const std::byte* p) {
  std::uint64_t word = 0;
  std::memcpy(&word, p, sizeof word);
  return word;
}

template <auto mix>
std::uint64_t checksum_by(std::span<const std::byte> data, std::uint64_t seed) {
  // Four lanes, so that the latency of the multiplications overlaps.
  std::uint64_t a = seed + odd_0, b = seed ^ odd_1, c = seed - odd_1, d = ~seed;
  const std::byte* p = data.data();
  std::size_t left = data.size();
  for (; left >= 32; left -= 32, p += 32) {
    a = mix(a, load(p));
    b = mix(b, load(p + 8));
    c = mix(c, load(p + 16));
    d = mix(d, load(p + 24));
  }
  std::uint64_t hash = mix(mix(mix(a, b), c), d);
  for (; left >= 8; left -= 8, p += 8) hash = mix(hash, load(p));
  if (left > 0) {
    std::uint64_t tail = 0;
    std::memcpy(&tail, p, left);
    hash = mix(hash, tail);
  }
  hash = mix(hash, data.size());  // trailing zero bytes count as well
  hash ^= hash >> 32;
  return hash * odd_1;
}

// Checksum of a header whose checksum is zero, and its payload.
std::uint64_t checksum_of(const FrameHeader& header, std::span<const std::byte> payload) {
  const auto both = [&](auto sum) { return sum(payload, sum(std::as_bytes(std::span(&header, 1)), 0)); };
  return header.version.minor < 4 ? both(checksum_by<mix_of_1_3>) : both(checksum_by<mix_word>);
}

}  // namespace

std::uint64_t checksum(std::span<const std::byte> data, std::uint64_t seed) {
  return checksum_by<mix_word>(data, seed);
}

void seal(FrameHeader& header, std::span<const std::byte> payload) {
  header.payload_size = payload.size();
  header.checksum = 0;
  header.checksum = checksum_of(header, payload);
}

FrameHeader open_frame(std::span<const std::byte> frame, const std::string& where) {
  const auto fail = [&](Violation violation, const std::string& problem, const std::string& hint = {}) {
    throw ProtocolError(violation, problem, where, hint);
  };
  FrameHeader header;
  if (frame.size() < sizeof header)
    fail(Violation::truncated,
         "a frame of " + std::to_string(frame.size()) + " bytes is shorter than its header");
  std::memcpy(&header, frame.data(), sizeof header);
  if (header.magic != frame_magic)
    fail(Violation::bad_magic, "a frame does not begin with TNDM",
         "the peer does not speak tandem's protocol");
  if (header.version.major != protocol_version.major)
    fail(Violation::wrong_version,
         "the peer speaks protocol major version " + std::to_string(header.version.major) +
             ", this program " + std::to_string(protocol_version.major),
         "install the same release of tandem on both sides");
  const std::size_t payload = frame.size() - sizeof header;
  if (header.payload_size > payload)
    fail(Violation::truncated, "a frame announces a payload of " + std::to_string(header.payload_size) +
                                   " bytes and holds " + std::to_string(payload));
  if (header.payload_size < payload)
    fail(Violation::trailing_bytes, "a frame announces a payload of " + std::to_string(header.payload_size) +
                                        " bytes and holds " + std::to_string(payload));
  FrameHeader blank = header;
  blank.checksum = 0;
  if (checksum_of(blank, payload_of(frame)) != header.checksum)
    fail(Violation::bad_checksum, "the checksum of a frame (" + std::string(name(header.kind)) +
                                      ", sequence " + std::to_string(header.sequence) +
                                      ") does not fit its bytes");
  if (header.reserved != 0 || header.flags != 0)
    fail(Violation::bad_header, "a reserved field of a frame's header is not zero");
  return header;
}

}  // namespace tandem::protocol
