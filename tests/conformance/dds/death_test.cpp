// Processes that die, stop and come back. fork() is safe here because no DDS entity exists at that time.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>

#include "ends.hpp"

namespace tandem::protocol::test {
namespace {

using testing::HasSubstr;

// A participant in another process, which says at its end on a pipe what it threw.
class Participant {
 public:
  template <class Body>
  Participant(const DdsOptions& options, Body body) {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    pid_ = fork();
    if (pid_ == 0) {
      alarm(60);
      std::string last = "nothing thrown";
      try {
        body(*open_dds_participant(options, in(10s)));
      } catch (const std::exception& e) {
        last = e.what();
      }
      const auto written = write(ends[1], last.data(), last.size());
      _exit(written == static_cast<ssize_t>(last.size()) ? 0 : 1);
    }
    close(ends[1]);
    pipe_ = ends[0];
  }
  ~Participant() {
    signal(SIGKILL);
    waitpid(pid_, nullptr, 0);
    close(pipe_);
  }
  void signal(int number) const { ::kill(pid_, number); }
  pid_t pid() const { return pid_; }
  std::string last_words() const {
    std::string words(1000, '\0');
    words.resize(static_cast<std::size_t>(std::max<ssize_t>(0, read(pipe_, words.data(), words.size()))));
    return words;
  }

 private:
  pid_t pid_ = -1;
  int pipe_ = -1;
};

const auto echo = [](Channel& channel) {
  for (;;) send(channel, receive(channel, 20s));
};

TEST(DdsDeath, AStoppedPeerThatComesBackStaysOut) {
  const Participant peer(options(), echo);
  const auto channel = open_dds_coordinator(options(), in(10s));
  send(*channel, ping);
  EXPECT_EQ(receive(*channel), ping);
  EXPECT_FALSE(channel->peer_gone());

  peer.signal(SIGSTOP);
  const auto begin = Clock::now();
  const Error lost = error_of([&] { receive(*channel); });
  EXPECT_EQ(lost.code(), ErrorCode::peer_lost);
  EXPECT_LT(Clock::now() - begin, 1s);
  EXPECT_THAT(lost.problem(), HasSubstr("dem_server (pid " + std::to_string(peer.pid())));
  EXPECT_THAT(lost.problem(), HasSubstr("fell silent for 400 ms"));
  EXPECT_TRUE(channel->peer_gone());

  peer.signal(SIGCONT);
  std::this_thread::sleep_for(700ms);
  EXPECT_TRUE(channel->peer_gone());
  EXPECT_STREQ(error_of([&] { send(*channel, ping); }).what(), lost.what());
  EXPECT_STREQ(error_of([&] { receive(*channel); }).what(), lost.what());
}

TEST(DdsDeath, APeerThatWasStoppedLearnsThatItIsOut) {
  const Participant peer(options(), echo);
  {
    const auto channel = open_dds_coordinator(options(), in(10s));
    peer.signal(SIGSTOP);
    EXPECT_EQ(error_of([&] { receive(*channel); }).code(), ErrorCode::peer_lost);
  }
  peer.signal(SIGCONT);
  const auto begin = Clock::now();
  EXPECT_THAT(peer.last_words(), HasSubstr("coordinator (pid " + std::to_string(getpid())));
  EXPECT_LT(Clock::now() - begin, 2s);
}

TEST(DdsDeath, AShortStopIsForgiven) {
  const Participant peer(options(), echo);
  const auto channel = open_dds_coordinator(options(), in(10s));
  for (int i = 0; i < 3; ++i) {
    peer.signal(SIGSTOP);
    std::this_thread::sleep_for(100ms);
    peer.signal(SIGCONT);
    send(*channel, ping);
    EXPECT_EQ(receive(*channel), ping);
  }
  EXPECT_FALSE(channel->peer_gone());
}

TEST(DdsDeath, AfterAKillTheSameRunStartsAgainAtOnce) {
  for (int i = 0; i < 3; ++i) {
    const Participant peer(options(), echo);
    const auto channel = open_dds_coordinator(options(), in(10s));
    send(*channel, ping);
    EXPECT_EQ(receive(*channel), ping);
    peer.signal(SIGKILL);
    if (i == 1) {
      EXPECT_EQ(error_of([&] { receive(*channel); }).code(), ErrorCode::peer_lost);
    }
  }
}

TEST(DdsDeath, AKilledCoordinatorIsLost) {
  // The roles are turned round: this process is the participant.
  const DdsOptions run = options();
  const pid_t coordinator = fork();
  if (coordinator == 0) {
    alarm(60);
    const auto channel = open_dds_coordinator(run, in(10s));
    send(*channel, ping);
    for (;;) pause();
  }
  const auto channel = open_dds_participant(run, in(10s));
  EXPECT_EQ(receive(*channel), ping);
  kill(coordinator, SIGKILL);
  const auto begin = Clock::now();
  EXPECT_EQ(error_of([&] { receive(*channel); }).code(), ErrorCode::peer_lost);
  EXPECT_LT(Clock::now() - begin, 1s);
  waitpid(coordinator, nullptr, 0);
}

// Not a test of speed: the figure is printed for docs/experiments/2026-11-channels.md.
TEST(DdsDeath, ARoundTripBetweenProcessesIsPrinted) {
  const Participant peer(options(), echo);
  const auto channel = open_dds_coordinator(options(), in(10s));
  std::vector<double> microseconds;
  for (int i = 0; i < 2000; ++i) {
    const auto begin = Clock::now();
    send(*channel, ping);
    ASSERT_EQ(receive(*channel), ping);
    microseconds.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
  }
  std::ranges::sort(microseconds);
  std::printf("512-byte round trip over DDS on lo: median %.1f us, 99 %% below %.1f us\n",
              microseconds[microseconds.size() / 2], microseconds[microseconds.size() * 99 / 100]);
}

}  // namespace
}  // namespace tandem::protocol::test
