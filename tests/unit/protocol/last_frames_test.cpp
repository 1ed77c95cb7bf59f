// What a failed run keeps: bounded in bytes, from the registration on, whole windows at the end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "common/error.hpp"
#include "protocol/last_frames.hpp"

namespace tandem::protocol::test {
namespace {

using testing::ElementsAre;

constexpr std::size_t kilobyte = 1024;

struct File {
  File() = default;
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { std::filesystem::remove(path); }
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("tandem_last_frames_" + std::to_string(getpid()));
};

void add(FrameSink& sink, Kind kind, std::uint64_t window, std::size_t payload, std::uint64_t number = 0) {
  const Bytes bytes(payload, std::byte(window));
  FrameHeader header;
  header.kind = kind;
  header.window = window;
  header.sequence = number;
  seal(header, bytes);
  sink.record(Direction::to_participant, Role::mbd, std::as_bytes(std::span(&header, 1)), bytes);
}

std::vector<RecordedFrame> read(const LastFrames& frames) {
  const File file;
  frames.write(file.path);
  RecordingReader reader(file.path);
  std::vector<RecordedFrame> all;
  for (RecordedFrame frame; reader.next(frame);) all.push_back(frame);
  return all;
}

TEST(LastFrames, AShortSessionIsKeptAsItWas) {
  LastFrames frames(64 * kilobyte);
  EXPECT_TRUE(frames.empty());
  add(frames, Kind::configure, 0, 1000);
  for (std::uint64_t window = 0; window < 3; ++window) add(frames, Kind::predict, window, 24);
  const auto all = read(frames);
  ASSERT_EQ(all.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_FALSE(all[i].missing);
    EXPECT_TRUE(all[i].has_payload);
    EXPECT_NO_THROW(open_frame(all[i].frame, "frame"));
  }
  EXPECT_EQ(all[0].header.kind, Kind::configure);
  EXPECT_EQ(all[3].header.window, 2u);
}

// The bound holds at all times, also across the end of the ring's memory, and every frame stays whole.
TEST(LastFrames, ALongSessionKeepsItsBeginningAndItsLastWindowsWithinTheBound) {
  constexpr std::size_t bound = 64 * kilobyte;
  LastFrames frames(bound);
  add(frames, Kind::configure, 0, 5000);
  constexpr std::uint64_t windows = 1000;
  for (std::uint64_t window = 0; window < windows; ++window) {
    for (std::uint64_t i = 0; i < 3; ++i) add(frames, Kind::predict, window, 100 + 8 * (window % 50), i);
    ASSERT_LE(frames.size(), bound);
  }
  const auto all = read(frames);
  ASSERT_GT(all.size(), 50u);
  EXPECT_EQ(all[0].header.kind, Kind::configure);
  ASSERT_TRUE(all[1].missing);
  EXPECT_EQ(all[1].missing->first_window, 0u);
  EXPECT_EQ(all[1].missing->last_window + 1, all[2].header.window) << "the first window there is whole";
  EXPECT_EQ(all[1].missing->frames, 3 * all[2].header.window);
  for (std::size_t i = 2; i < all.size(); ++i) {
    EXPECT_NO_THROW(open_frame(all[i].frame, "frame")) << i;
    EXPECT_EQ(all[i].header.window, all[2].header.window + (i - 2) / 3);
    EXPECT_EQ(all[i].header.sequence, (i - 2) % 3);
  }
  EXPECT_EQ(all.back().header.window, windows - 1);
}

TEST(LastFrames, APayloadThatIsTooLargeLeavesItsHeader) {
  LastFrames frames(64 * kilobyte);
  add(frames, Kind::configure, 0, 100 * kilobyte);
  add(frames, Kind::predict, 0, 24);
  add(frames, Kind::particles, 0, 5 * kilobyte);
  add(frames, Kind::predict, 1, 24);
  const auto all = read(frames);
  std::vector<bool> kept;
  for (const auto& frame : all) kept.push_back(frame.has_payload);
  EXPECT_THAT(kept, ElementsAre(false, true, false, true));
  EXPECT_EQ(all[2].header.payload_size, 5 * kilobyte);
  EXPECT_EQ(all[2].header.kind, Kind::particles);
}

// A single window may have more frames than the bound.
TEST(LastFrames, ALongWindowKeepsItsLastFrames) {
  LastFrames frames(64 * kilobyte);
  for (std::uint64_t i = 0; i < 1000; ++i) add(frames, Kind::predict, 7, 200, i);
  const auto all = read(frames);
  ASSERT_GT(all.size(), 1u);
  ASSERT_TRUE(all[0].missing);
  EXPECT_EQ(all[0].missing->first_window, 7u);
  EXPECT_EQ(all[0].missing->last_window, 7u);
  EXPECT_EQ(all[0].missing->frames + all.size() - 1, 1000u);
  EXPECT_EQ(all.back().header.sequence, 999u);
}

TEST(LastFrames, AFolderThatIsNotThereIsAnErrorAndLeavesNothing) {
  LastFrames frames(64 * kilobyte);
  add(frames, Kind::predict, 0, 24);
  EXPECT_THROW(frames.write("/tandem_no_such_folder/last_windows.rec"), Error);
}

}  // namespace
}  // namespace tandem::protocol::test
