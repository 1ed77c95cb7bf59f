// The contract of protocol/channel.hpp, for every channel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <cstring>
#include <random>
#include <thread>

#include "allocations.hpp"
#include "channel_factory.hpp"
#include "common/error.hpp"
#include "protocol/frame.hpp"

namespace tandem::protocol::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

Deadline in(Clock::duration time) {
  return Clock::now() + time;
}

// Reproducible content of any size, which tells frames of different seeds apart.
Bytes content(std::size_t size, std::uint64_t seed) {
  Bytes bytes(size);
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < size; i += 8) {
    const std::uint64_t word = random();
    std::memcpy(bytes.data() + i, &word, std::min<std::size_t>(8, size - i));
  }
  return bytes;
}

void send(Channel& channel, std::span<const std::byte> bytes, Clock::duration patience = 20s) {
  const std::array<std::span<const std::byte>, 1> parts{bytes};
  channel.send(parts, in(patience));
}

Bytes receive(Channel& channel, Clock::duration patience = 20s) {
  Bytes frame;
  channel.receive(frame, in(patience));
  return frame;
}

Error error_of(auto&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << "nothing was thrown";
  return {ErrorCode::internal, ""};
}

class ChannelConformance : public testing::TestWithParam<ChannelFactory> {};

TEST_P(ChannelConformance, FramesArriveWholeOnceAndInOrder) {
  auto [a, b] = GetParam().pair();
  constexpr std::size_t frames = 300;
  std::jthread reader([&, end = b.get()] {
    for (std::size_t i = 0; i < frames; ++i)
      ASSERT_EQ(receive(*end), content(i * 37 % 9000, i)) << "frame " << i;
  });
  for (std::size_t i = 0; i < frames; ++i) send(*a, content(i * 37 % 9000, i));
}

TEST_P(ChannelConformance, PartsBecomeOneFrame) {
  auto [a, b] = GetParam().pair();
  const Bytes whole = content(1000, 1);
  const std::span all(whole);
  const std::array<std::span<const std::byte>, 4> parts{all.first(64), all.subspan(64, 0), all.subspan(64, 1),
                                                        all.subspan(65)};
  std::jthread reader([&, end = b.get()] { EXPECT_EQ(receive(*end), whole); });
  a->send(parts, in(5s));
}

TEST_P(ChannelConformance, AnEmptyFrameIsAFrame) {
  auto [a, b] = GetParam().pair();
  send(*a, {});
  send(*a, content(3, 1));
  EXPECT_TRUE(receive(*b).empty());
  EXPECT_EQ(receive(*b), content(3, 1));
}

TEST_P(ChannelConformance, AFrameOfTensOfMebibytesPasses) {
  auto [a, b] = GetParam().pair();
  const Bytes large = content(std::size_t{40} << 20, 9);
  constexpr auto patience = 100s;  // with a sanitizer, on a busy machine
  std::jthread reader([&, end = b.get()] {
    EXPECT_TRUE(receive(*end, patience) == large);
    send(*end, large, patience);
  });
  send(*a, large, patience);
  EXPECT_TRUE(receive(*a, patience) == large);
}

TEST_P(ChannelConformance, BothDirectionsAtOnceUnderStress) {
  auto [a, b] = GetParam().pair();
  constexpr int rounds = 2000;
  const auto talk = [](Channel& end, std::uint64_t mine, std::uint64_t theirs) {
    std::mt19937_64 my_size(mine), their_size(theirs);
    for (int i = 0; i < rounds; ++i) {
      const auto size = [&](auto& random) {
        return random() % 100 == 0 ? random() % 200'000 : random() % 600;
      };
      send(end, content(size(my_size), mine + static_cast<std::uint64_t>(i)));
      const Bytes expected = content(size(their_size), theirs + static_cast<std::uint64_t>(i));
      ASSERT_EQ(checksum(receive(end)), checksum(expected)) << "frame " << i;
    }
  };
  // One sends first and one receives first, or two large frames wait for each other.
  std::jthread other([&, end = b.get()] {
    std::mt19937_64 size_a(1000), size_b(5000);
    for (int i = 0; i < rounds; ++i) {
      const auto size = [&](auto& random) {
        return random() % 100 == 0 ? random() % 200'000 : random() % 600;
      };
      const Bytes expected = content(size(size_a), 1000 + static_cast<std::uint64_t>(i));
      ASSERT_EQ(checksum(receive(*end)), checksum(expected)) << "frame " << i;
      send(*end, content(size(size_b), 5000 + static_cast<std::uint64_t>(i)));
    }
  });
  talk(*a, 1000, 5000);
}

TEST_P(ChannelConformance, WaitTellsOfAFrameAndItsDeadlineIsNoFailure) {
  auto [a, b] = GetParam().pair();
  const auto begin = Clock::now();
  EXPECT_FALSE(b->wait(in(60ms)));
  EXPECT_GE(Clock::now() - begin, 60ms);
  send(*a, content(10, 1));
  EXPECT_TRUE(b->wait(in(5s)));
  EXPECT_TRUE(b->wait(in(5s)));
  EXPECT_EQ(receive(*b), content(10, 1));
}

TEST_P(ChannelConformance, NoCallOutlivesItsDeadline) {
  auto [a, b] = GetParam().pair();
  const auto begin = Clock::now();
  const Error e = error_of([&, end = b.get()] { receive(*end, 100ms); });
  EXPECT_EQ(e.code(), ErrorCode::timeout);
  EXPECT_THAT(e.what(), HasSubstr(b->peer()));
  EXPECT_GE(Clock::now() - begin, 100ms);
  EXPECT_LT(Clock::now() - begin, 5s);
  // A frame that nobody takes: it does not fit into any buffer, or many of them do not.
  EXPECT_EQ(error_of([&, end = a.get()] {
              for (int i = 0; i < 1000; ++i) send(*end, content(std::size_t{1} << 20, 1), 100ms);
            }).code(),
            ErrorCode::timeout);
}

TEST_P(ChannelConformance, AFailureIsLatched) {
  auto [a, b] = GetParam().pair();
  const Error first = error_of([&, end = b.get()] { receive(*end, 20ms); });
  send(*a, content(10, 1));  // too late
  EXPECT_STREQ(error_of([&, end = b.get()] { receive(*end); }).what(), first.what());
  EXPECT_STREQ(error_of([&, end = b.get()] { end->wait(in(1s)); }).what(), first.what());
  EXPECT_STREQ(error_of([&, end = b.get()] { send(*end, content(10, 1)); }).what(), first.what());
}

TEST_P(ChannelConformance, APeerThatClosesIsLostAfterItsLastFrame) {
  auto [a, b] = GetParam().pair();
  send(*b, content(100, 1));
  EXPECT_FALSE(a->peer_gone());
  b.reset();
  EXPECT_EQ(receive(*a), content(100, 1));
  const auto begin = Clock::now();
  const Error e = error_of([&, end = a.get()] { receive(*end); });
  EXPECT_EQ(e.code(), ErrorCode::peer_lost);
  EXPECT_THAT(e.what(), HasSubstr(GetParam().peer));
  EXPECT_LT(Clock::now() - begin, 1s + GetParam().death_is_seen_in);
  EXPECT_TRUE(a->peer_gone());
  EXPECT_EQ(error_of([&, end = a.get()] { send(*end, content(10, 1)); }).code(), ErrorCode::peer_lost);
}

TEST_P(ChannelConformance, APeerThatClosesWakesTheOneWhoWaits) {
  auto [a, b] = GetParam().pair();
  std::jthread closer([end = std::move(b)]() mutable {
    std::this_thread::sleep_for(50ms);
    end.reset();
  });
  EXPECT_EQ(error_of([&, end = a.get()] { receive(*end); }).code(), ErrorCode::peer_lost);
}

TEST_P(ChannelConformance, ASteadyExchangeDoesNotAllocate) {
  if (!GetParam().allocation_free) GTEST_SKIP() << "the transport allocates by itself";
  auto [a, b] = GetParam().pair();
  const Bytes frame = content(512, 1);
  Bytes in_a, in_b;
  const auto round_trip = [&, first = a.get(), second = b.get()] {
    send(*first, frame);
    second->receive(in_b, in(5s));
    send(*second, frame);
    first->receive(in_a, in(5s));
  };
  for (int i = 0; i < 20; ++i) round_trip();
  const std::size_t before = allocations();
  for (int i = 0; i < 500; ++i) round_trip();
  EXPECT_EQ(allocations() - before, 0u);
}

TEST_P(ChannelConformance, ManyChannelsAtOnceDoNotMix) {
  std::vector<Ends> ends;
  for (int i = 0; i < 4; ++i) ends.push_back(GetParam().pair());
  for (std::uint64_t i = 0; i < ends.size(); ++i) send(*ends[i].first, content(50, i));
  for (std::uint64_t i = ends.size(); i-- > 0;) EXPECT_EQ(receive(*ends[i].second), content(50, i));
}

// ---- across processes

class ProcessConformance : public testing::TestWithParam<ChannelFactory> {
 protected:
  static std::unique_ptr<Child> child(
      const std::function<void(Channel&)>& body, const std::function<void()>& before_attach = [] {}) {
    return GetParam().child(before_attach, body);
  }
};

TEST_P(ProcessConformance, AnotherProcessAnswers) {
  const auto echo = child([](Channel& channel) {
    for (int i = 0; i < 200; ++i) send(channel, receive(channel));
    receive(channel);  // until the parent has seen everything
  });
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Bytes bytes = content(i * 331, i);
    std::jthread writer([&] { send(echo->channel(), bytes); });
    writer.join();
    ASSERT_EQ(receive(echo->channel()), bytes);
  }
  EXPECT_THAT(echo->channel().peer(), HasSubstr(GetParam().peer));
}

void expect_lost_soon(const ChannelFactory& factory, const std::function<void()>& call) {
  const auto begin = Clock::now();
  const Error e = error_of(call);
  EXPECT_EQ(e.code(), ErrorCode::peer_lost) << e.what();
  EXPECT_THAT(e.what(), HasSubstr(factory.peer));
  EXPECT_LT(Clock::now() - begin, factory.death_is_seen_in);
}

TEST_P(ProcessConformance, AParticipantThatDiesBeforeItAttachesIsLost) {
  if (GetParam().opens_with_peer) GTEST_SKIP() << "this channel opens only with its peer";
  const auto peer = child([](Channel&) {}, [] { ::raise(SIGKILL); });
  expect_lost_soon(GetParam(), [&] { receive(peer->channel()); });
}

TEST_P(ProcessConformance, AKilledParticipantIsLostWhileWeReceive) {
  const auto peer = child([](Channel& channel) {
    send(channel, content(10, 1));
    receive(channel);
  });
  EXPECT_EQ(receive(peer->channel()), content(10, 1));
  EXPECT_FALSE(peer->channel().peer_gone());
  peer->kill();  // a zombie from now on
  expect_lost_soon(GetParam(), [&] { receive(peer->channel()); });
  EXPECT_TRUE(peer->channel().peer_gone());
}

TEST_P(ProcessConformance, AKilledParticipantIsLostWhileWeSend) {
  const auto peer = child([](Channel& channel) {
    send(channel, content(10, 1));
    std::this_thread::sleep_for(30s);
  });
  EXPECT_EQ(receive(peer->channel()), content(10, 1));
  peer->kill();
  expect_lost_soon(GetParam(), [&] {
    while (true) send(peer->channel(), content(100, 1));
  });
}

TEST_P(ProcessConformance, AParticipantKilledInMidFrameIsLost) {
  // It streams a frame of which we take only the beginning for granted.
  const auto peer = child([](Channel& channel) {
    send(channel, content(10, 1));
    send(channel, content(std::size_t{32} << 20, 2));
  });
  EXPECT_EQ(receive(peer->channel()), content(10, 1));
  ASSERT_TRUE(peer->channel().wait(in(5s)));
  std::this_thread::sleep_for(20ms);  // the buffers are full, the child waits for room
  peer->kill();
  expect_lost_soon(GetParam(), [&] { receive(peer->channel()); });
}

TEST_P(ProcessConformance, WhatAParticipantSentBeforeItDiedArrives) {
  const auto peer = child([](Channel& channel) {
    for (std::uint64_t i = 0; i < 3; ++i) send(channel, content(700, i));
    std::this_thread::sleep_for(100ms);  // sent is what has left the process
    ::raise(SIGKILL);
  });
  std::this_thread::sleep_for(300ms);
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(receive(peer->channel()), content(700, i));
  expect_lost_soon(GetParam(), [&] { receive(peer->channel()); });
}

TEST_P(ProcessConformance, AStoppedParticipantIsATimeoutOrLostButNoHang) {
  const auto peer = child([](Channel& channel) {
    send(channel, content(10, 1));
    ::raise(SIGSTOP);
  });
  EXPECT_EQ(receive(peer->channel()), content(10, 1));
  const ErrorCode code = error_of([&] { receive(peer->channel(), 300ms); }).code();
  EXPECT_TRUE(code == ErrorCode::timeout || code == ErrorCode::peer_lost);
}

std::string name_of(const testing::TestParamInfo<ChannelFactory>& factory) {
  return factory.param.name;
}

std::vector<ChannelFactory> factories_with_processes() {
  std::vector<ChannelFactory> factories = all_factories();
  std::erase_if(factories, [](const ChannelFactory& factory) { return !factory.child; });
  return factories;
}

INSTANTIATE_TEST_SUITE_P(Channels, ChannelConformance, testing::ValuesIn(all_factories()), name_of);
INSTANTIATE_TEST_SUITE_P(Channels, ProcessConformance, testing::ValuesIn(factories_with_processes()),
                         name_of);

}  // namespace
}  // namespace tandem::protocol::test
