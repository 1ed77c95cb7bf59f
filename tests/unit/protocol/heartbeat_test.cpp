// Silence over shared memory: which peers are judged, and when.
#include "protocol/shm/heartbeat.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "protocol/channel.hpp"

namespace tandem::protocol::shm {
namespace {

using namespace std::chrono_literals;

// Waits at most `patience` for a silence to be detected.
bool noticed(const Heartbeat& heartbeat, Clock::duration patience) {
  const Deadline deadline = Clock::now() + patience;
  while (!heartbeat.silent() && Clock::now() < deadline) std::this_thread::sleep_for(5ms);
  return heartbeat.silent();
}

TEST(Heartbeat, APeerThatStopsToBeatIsNoticedAndStaysOut) {
  std::atomic<std::uint32_t> ours = 0, theirs = 0;
  const Heartbeat heartbeat(ours, theirs, 200ms);
  std::optional<Heartbeat> peer(std::in_place, theirs, ours, 200ms);
  std::this_thread::sleep_for(500ms);
  EXPECT_FALSE(heartbeat.silent());
  EXPECT_FALSE(peer->silent());
  peer.reset();
  EXPECT_TRUE(noticed(heartbeat, 10s));
  peer.emplace(theirs, ours, 200ms);
  std::this_thread::sleep_for(100ms);
  EXPECT_TRUE(heartbeat.silent());
}

TEST(Heartbeat, APeerThatNeverBeatIsNotJudged) {
  std::atomic<std::uint32_t> ours = 0, theirs = 0;
  const Heartbeat heartbeat(ours, theirs, 50ms);
  EXPECT_FALSE(noticed(heartbeat, 300ms)) << "a participant of protocol 1.3 does not beat";
  EXPECT_GT(ours, 5u);
}

TEST(Heartbeat, WithoutALeaseNobodyIsJudged) {
  std::atomic<std::uint32_t> ours = 0, theirs = 7;
  const Heartbeat heartbeat(ours, theirs, 0ms);
  EXPECT_FALSE(noticed(heartbeat, 300ms));
}

TEST(Heartbeat, CountsPastZeroWhichSaysNothing) {
  std::atomic<std::uint32_t> ours = ~std::uint32_t{0}, theirs = 0;
  const Heartbeat heartbeat(ours, theirs, 50ms);
  EXPECT_NE(ours, 0u);
}

}  // namespace
}  // namespace tandem::protocol::shm
