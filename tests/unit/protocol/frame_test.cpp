#include "protocol/frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "protocol/codec.hpp"
#include "protocol/layout.hpp"
#include "protocol/violation.hpp"

namespace tandem::protocol::test {
namespace {

Bytes frame_of(const Bytes& payload, FrameHeader header = {}) {
  header.kind = Kind::save;
  header.run_id = 7;
  header.window = 3;
  header.sequence = 5;
  seal(header, payload);
  Bytes frame(sizeof header + payload.size());
  std::memcpy(frame.data(), &header, sizeof header);
  std::ranges::copy(payload, frame.begin() + sizeof header);
  return frame;
}

Bytes some_bytes(std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 7 + 1);
  return bytes;
}

Violation violation_of(const Bytes& frame) {
  try {
    open_frame(frame, "peer");
  } catch (const ProtocolError& e) {
    EXPECT_EQ(e.where(), "peer");
    return e.violation();
  }
  ADD_FAILURE() << "the frame was accepted";
  return {};
}

TEST(Frame, IsOpenedAsItWasSealed) {
  for (const std::size_t size : {0, 1, 7, 8, 31, 32, 33, 64, 1000}) {
    const Bytes frame = frame_of(some_bytes(size));
    const FrameHeader header = open_frame(frame, "peer");
    EXPECT_EQ(header.kind, Kind::save);
    EXPECT_EQ(header.run_id, 7u);
    EXPECT_EQ(header.window, 3u);
    EXPECT_EQ(header.sequence, 5u);
    EXPECT_EQ(header.payload_size, size);
    EXPECT_TRUE(std::ranges::equal(payload_of(frame), some_bytes(size)));
  }
}

TEST(Frame, EveryFlippedBitIsFound) {
  const Bytes good = frame_of(some_bytes(75));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Bytes bad = good;
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    EXPECT_THROW(open_frame(bad, "peer"), ProtocolError) << "bit " << bit;
  }
}

TEST(Frame, EachKindOfDamageHasItsName) {
  const Bytes good = frame_of(some_bytes(40));
  Bytes bad = good;
  bad.resize(63);
  EXPECT_EQ(violation_of(bad), Violation::truncated);
  bad.clear();
  EXPECT_EQ(violation_of(bad), Violation::truncated);
  bad = good;
  bad.pop_back();
  EXPECT_EQ(violation_of(bad), Violation::truncated);
  bad = good;
  bad.push_back(std::byte{0});
  EXPECT_EQ(violation_of(bad), Violation::trailing_bytes);
  bad = good;
  bad[0] = std::byte{'X'};
  EXPECT_EQ(violation_of(bad), Violation::bad_magic);
  bad = good;
  bad[70] ^= std::byte{1};
  EXPECT_EQ(violation_of(bad), Violation::bad_checksum);
  FrameHeader other;
  other.version.major = 2;
  EXPECT_EQ(violation_of(frame_of({}, other)), Violation::wrong_version);
  FrameHeader flagged;
  flagged.flags = 1;
  EXPECT_EQ(violation_of(frame_of({}, flagged)), Violation::bad_header);
}

TEST(Frame, AnotherMinorVersionIsForTheSessionToJudge) {
  FrameHeader header;
  header.version.minor = 7;
  EXPECT_EQ(open_frame(frame_of({}, header), "peer").version.minor, 7);
}

TEST(Checksum, TellsZerosOfDifferentLengthsAndOrdersApart) {
  std::set<std::uint64_t> seen;
  for (std::size_t size = 0; size < 200; ++size) seen.insert(checksum(Bytes(size)));
  EXPECT_EQ(seen.size(), 200u);
  Bytes a = some_bytes(64), b = a;
  std::swap_ranges(b.begin(), b.begin() + 32, b.begin() + 32);
  EXPECT_NE(checksum(a), checksum(b));
  EXPECT_NE(checksum(a, 1), checksum(a, 2));
}

TEST(Checksum, NoTwoChangedBitsCancel) {
  Bytes frame = some_bytes(104);
  const std::uint64_t whole = checksum(frame);
  const auto flip = [&](std::size_t bit) { frame[bit / 8] ^= std::byte{1} << bit % 8; };
  for (std::size_t first = 0; first < 8 * frame.size(); ++first) {
    flip(first);
    ASSERT_NE(checksum(frame), whole) << first;
    for (std::size_t second = first + 1; second < 8 * frame.size(); ++second) {
      flip(second);
      ASSERT_NE(checksum(frame), whole) << first << " " << second;
      flip(second);
    }
    flip(first);
  }
}

TEST(Checksum, OfVersion1_3IsWhatItWas) {
  FrameHeader header;
  header.version.minor = 3;
  seal(header, some_bytes(100));
  EXPECT_EQ(header.checksum, 17310388525892330286u);
}

TEST(Checksum, IsTheSameOnEveryMachine) {
  // A fixed number: two builds with different checksums could not communicate.
  EXPECT_EQ(checksum(some_bytes(100)), 5195462559491765264u);
}

TEST(Layout, HashFollowsTheLists) {
  static_assert(layout_hash != 0);
  static_assert(layout::add(layout::start, "ab") != layout::add(layout::start, "ba"));
  static_assert(layout::add(layout::add(layout::start, "a"), "bc") !=
                layout::add(layout::add(layout::start, "ab"), "c"));
  EXPECT_NE(layout::of_messages(), layout::of_records());
}

}  // namespace
}  // namespace tandem::protocol::test
