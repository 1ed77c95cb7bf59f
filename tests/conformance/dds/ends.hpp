// Ends of DDS channels for the tests, on the loopback and each test in a run of its own.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <future>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "protocol/dds/dds_channel.hpp"

namespace tandem::protocol::test {

using namespace std::chrono_literals;

inline Deadline in(Clock::duration time) {
  return Clock::now() + time;
}

// Other processes may run the same test at the same time.
inline DdsOptions options(const std::string& suffix = {}) {
  DdsOptions options;
  options.run = "test-" + std::to_string(getpid()) + "-" +
                testing::UnitTest::GetInstance()->current_test_info()->name() + suffix;
  options.role = Role::dem;
  options.secret = "the secret of this test, long enough";
  return options;
}

// The barrier lets neither end through alone, so they open side by side. First is the coordinator's.
inline std::pair<std::unique_ptr<Channel>, std::unique_ptr<Channel>> open_pair(const DdsOptions& options) {
  auto participant = std::async(std::launch::async, [&] { return open_dds_participant(options, in(10s)); });
  auto coordinator = open_dds_coordinator(options, in(10s));
  return {std::move(coordinator), participant.get()};
}

inline void send(Channel& channel, const std::vector<std::byte>& bytes) {
  const std::array<std::span<const std::byte>, 1> parts{bytes};
  channel.send(parts, in(10s));
}

inline std::vector<std::byte> receive(Channel& channel, Clock::duration patience = 10s) {
  std::vector<std::byte> frame;
  channel.receive(frame, in(patience));
  return frame;
}

inline const std::vector<std::byte> ping(512, std::byte{7});

inline void expect_works(Channel& a, Channel& b) {
  send(a, ping);
  EXPECT_EQ(receive(b), ping);
  send(b, ping);
  EXPECT_EQ(receive(a), ping);
}

template <class F>
Error error_of(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << "nothing was thrown";
  return {ErrorCode::internal, ""};
}

}  // namespace tandem::protocol::test
