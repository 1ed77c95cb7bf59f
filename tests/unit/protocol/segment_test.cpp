// The shared memory itself: access rights, and refusals before it is used.
#include "protocol/shm/segment.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cstring>

#include "common/error.hpp"
#include "protocol/registration.hpp"
#include "protocol/shm/ring.hpp"

namespace tandem::protocol::shm {
namespace {

using testing::HasSubstr;

void expect_refused(const Fd& memory, const std::string& text) {
  try {
    const Segment segment(memory);
    ADD_FAILURE() << "accepted, expected: " << text;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::protocol);
    EXPECT_THAT(e.what(), HasSubstr(text));
  }
}

TEST(Segment, IsPrivateAndOfSealedSize) {
  const Fd memory = create_memory(8192);
  struct stat status {};
  ASSERT_EQ(fstat(memory.get(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
  EXPECT_NE(ftruncate(memory.get(), 0), 0) << "the memory could be cut short under its users";
  EXPECT_NE(ftruncate(memory.get(), 1 << 20), 0);
  EXPECT_NE(fcntl(memory.get(), F_GETFD) & FD_CLOEXEC, 0);
}

// A participant reads the mark before it has said which version it speaks.
TEST(Segment, TheMarkIsThatOfTheOldestVersionServed) {
  EXPECT_EQ(segment_layout, std::end(dialects)[-1].layout_hash);
}

TEST(Segment, TwoMappingsAreOneMemory) {
  const Fd memory = create_memory(4096);
  const Segment a(memory), b(memory);
  ASSERT_NE(&a.head(), &b.head());
  a.head().to_participant.written = 5;
  EXPECT_EQ(b.head().to_participant.written, 5u);
  a.ring(1)[4095] = std::byte{7};
  EXPECT_EQ(b.ring(1)[4095], std::byte{7});
}

TEST(Segment, WhatIsNotOursIsRefused) {
  const Fd small(memfd_create("test", MFD_ALLOW_SEALING));
  expect_refused(small, "too small");
  ASSERT_EQ(ftruncate(small.get(), 1 << 16), 0);
  expect_refused(small, "could shrink");
  ASSERT_EQ(fcntl(small.get(), F_ADD_SEALS, F_SEAL_SHRINK), 0);
  expect_refused(small, "is not ours");

  const Fd memory = create_memory(4096);
  const Segment segment(memory);
  segment.head().ready = 0;
  expect_refused(memory, "is not ours");
  segment.head().ready = 1;
  ++segment.head().layout;
  expect_refused(memory, "another layout");
  --segment.head().layout;
  segment.head().ring_bytes *= 2;
  expect_refused(memory, "wrong size");
  segment.head().ring_bytes = 4096;
  const Segment again(memory);
}

TEST(Ring, DamagedCountersAndSizesAreErrorsNotAccesses) {
  const Fd memory = create_memory(4096);
  const Segment segment(memory);
  RingHead& head = segment.head().to_participant;
  const auto never = [] { return false; };
  std::vector<std::byte> frame;
  const auto read = [&] {
    RingReader reader(head, segment.ring(0), 4096, WaitPolicy::block, never);
    reader.read(frame, Clock::now());
  };
  head.written = 5000;  // more than the ring holds
  EXPECT_THROW(read(), Error);
  const std::uint64_t huge = ~std::uint64_t{0};
  std::memcpy(segment.ring(0), &huge, 8);
  head.written = 8;
  EXPECT_THROW(read(), Error);
  head.written = 0;
  head.read = 1;  // more than was written
  RingWriter writer(head, segment.ring(0), 4096, WaitPolicy::block, never);
  EXPECT_THROW(writer.write({}, Clock::now()), Error);
}

TEST(Ring, AnAnnouncedSizeTakesNoMemoryBeforeItsBytesCome) {
  const Fd memory = create_memory(4096);
  const Segment segment(memory);
  RingHead& head = segment.head().to_participant;
  const auto never = [] { return false; };
  const std::uint64_t announced = 3'600'000'000;
  std::memcpy(segment.ring(0), &announced, 8);
  head.written = 8;
  RingReader reader(head, segment.ring(0), 4096, WaitPolicy::block, never);
  std::vector<std::byte> frame;
  EXPECT_EQ(reader.read(frame, Clock::now()), Waiter::Outcome::deadline);
  EXPECT_LE(frame.capacity(), std::size_t{1} << 20) << "bytes are taken for 8 that came";
}

}  // namespace
}  // namespace tandem::protocol::shm
