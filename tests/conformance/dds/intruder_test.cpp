// Others on the network who know all of a run but its secret, in processes of another user where we may: they
// squat, forge, replay, dispose and flood, and the run does not notice.
#include <gmock/gmock.h>
#include <grp.h>
#include <sys/wait.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "common/log.hpp"
#include "ends.hpp"
#include "intruder_end.hpp"

namespace tandem::protocol::test {
namespace {

using testing::HasSubstr;

// In a process of its own, to be made before this one has DDS entities. `act` is called again and again.
class Intruder {
 public:
  template <class Act>
  Intruder(const DdsOptions& run, Act act) {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    pid_ = fork();
    if (pid_ == 0) {
      alarm(60);
      if (geteuid() == 0 && (setgroups(0, nullptr) != 0 || setgid(65534) != 0 || setuid(65534) != 0))
        _exit(1);
      IntruderEnd end(run);
      for (std::uint64_t deeds = 0;; deeds += act(end))
        if (deeds > 0) {
          static_cast<void>(write(ends[1], "x", 1));
          close(std::exchange(ends[1], -1));
        }
    }
    close(ends[1]);
    pipe_ = ends[0];
  }
  ~Intruder() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    close(pipe_);
  }
  // Blocks until it has done something.
  void await() const {
    char byte = 0;
    EXPECT_EQ(read(pipe_, &byte, 1), 1);
  }

 private:
  pid_t pid_ = -1;
  int pipe_ = -1;
};

// The log of this process in a file, from now on.
class LogFile {
 public:
  LogFile() { log::setup("test", "info", path_); }
  ~LogFile() {
    log::setup("test");
    std::filesystem::remove(path_);
  }
  std::string text() const {
    spdlog::default_logger()->flush();
    std::stringstream text;
    text << std::ifstream(path_).rdbuf();
    return text.str();
  }

 private:
  std::string path_ =
      std::filesystem::temp_directory_path() / ("tandem_intruder_" + std::to_string(getpid()));
};

tandem_dds_Presence squatter(const IntruderEnd& end, tandem_dds_Side side) {
  tandem_dds_Presence presence{};
  std::memcpy(presence.end, end.id, sizeof end.id);
  presence.side = side;
  presence.pid = 1;
  std::strcpy(presence.host, "elsewhere\n");
  return presence;
}

void expect_long_talk(Channel& a, Channel& b) {
  for (int i = 0; i < 200; ++i) expect_works(a, b);
  // Longer than what may be under way, so that it needs word of what was taken.
  const std::vector<std::byte> large(std::size_t{40} << 20, std::byte{3});
  std::jthread reader([&] { EXPECT_TRUE(receive(b, 50s) == large); });
  const std::array<std::span<const std::byte>, 1> parts{large};
  a.send(parts, in(50s));
}

TEST(DdsIntruder, SquattersAreRefusedAndNamed) {
  const DdsOptions run = options();
  const Intruder intruder(run, [](IntruderEnd& end) {
    for (const auto side : {tandem_dds_participant_side, tandem_dds_coordinator_side}) {
      auto presence = squatter(end, side);
      // Free, and then the partner of whoever is there.
      dds_write(end.presences, &presence);
      for (const auto& other : end.heard()) {
        std::memcpy(presence.partner, other.end, sizeof other.end);
        std::memcpy(presence.partner_nonce, other.own_nonce, sizeof other.own_nonce);
        presence.asks = tandem_dds_secret_proof;
        dds_write(end.presences, &presence);
      }
    }
    std::this_thread::sleep_for(5ms);
    return 1;
  });
  intruder.await();
  const LogFile log;
  const auto [coordinator, participant] = open_pair(run);
  EXPECT_THAT(coordinator->peer(), HasSubstr("(pid " + std::to_string(getpid())));
  EXPECT_THAT(participant->peer(), HasSubstr("(pid " + std::to_string(getpid())));
  expect_long_talk(*coordinator, *participant);
  // It presents itself both ways, and the log has the reason of some of its messages.
  EXPECT_THAT(log.text(), testing::AnyOf(HasSubstr("(pid 1 on elsewhere?): it has no secret"),
                                         HasSubstr("(pid 1 on elsewhere?): its secret is not this run's")));
}

TEST(DdsIntruder, ForgedReplayedAndFloodedMessagesAreRefused) {
  const DdsOptions run = options();
  const Intruder intruder(run, [](IntruderEnd& end) {
    static std::uint64_t number = 0;
    const auto heard = end.heard();
    std::uint64_t deeds = 0;
    for (const auto& from : heard) {
      auto replayed = from;  // its tag holds
      dds_write(end.presences, &replayed);
      dds_dispose(end.presences, &replayed);
      for (const auto& to : heard) {
        if (from.side == to.side) continue;
        tandem_dds_Chunk chunk{};
        std::memcpy(chunk.sender, from.end, sizeof from.end);
        std::memcpy(chunk.receiver, to.end, sizeof to.end);
        std::vector<std::uint8_t> bytes(4096, 9);
        chunk.frame_size = bytes.size();
        chunk.bytes = {4096, 4096, bytes.data(), false};
        for (int i = 0; i < 50; ++i) {
          chunk.number = ++number % 1000;
          dds_write(from.side == tandem_dds_coordinator_side ? end.commands : end.answers, &chunk);
          ++deeds;
        }
      }
    }
    for (int i = 0; i < 50 && !heard.empty(); ++i) {
      auto presence = squatter(end, tandem_dds_participant_side);
      presence.pid = static_cast<std::int64_t>(++number % 500);
      std::memcpy(presence.end, &presence.pid, sizeof presence.pid);  // another instance each
      dds_write(end.presences, &presence);
    }
    return deeds;
  });
  const LogFile log;
  const auto [coordinator, participant] = open_pair(run);
  intruder.await();
  expect_long_talk(*coordinator, *participant);
  expect_long_talk(*participant, *coordinator);
  EXPECT_THAT(log.text(), HasSubstr("it sent data"));
}

TEST(DdsIntruder, AReplayedPresenceDoesNotHideTheEndThatItIsOf) {
  const DdsOptions run = options();
  const Intruder intruder(run, [](IntruderEnd& end) {
    const auto heard = end.heard();
    for (auto presence : heard) {
      dds_write(end.presences, &presence);
      dds_dispose(end.presences, &presence);
    }
    std::this_thread::sleep_for(1ms);
    return static_cast<std::uint64_t>(heard.size());
  });
  auto participant = std::async(std::launch::async, [&] { return open_dds_participant(run, in(10s)); });
  intruder.await();  // from here on, whoever comes hears the participant and its recording
  const auto coordinator = open_dds_coordinator(run, in(10s));
  expect_long_talk(*coordinator, *participant.get());
}

// What a secret does not prevent (docs/security.md): here it is at least said.
TEST(DdsIntruder, AReaderThatHoldsUpARunIsNamed) {
  const DdsOptions run = options();
  DdsOptions patient = run;
  patient.lease = 60s;  // nobody gives it up
  const Intruder intruder(patient, [&, reads = false](IntruderEnd& end) mutable {
    if (!std::exchange(reads, true)) end.read_along(patient);
    if (end.heard().size() < 2) return 0;
    std::this_thread::sleep_for(300ms);
    ::raise(SIGSTOP);
    return 0;
  });
  const LogFile log;
  const auto [coordinator, participant] = open_pair(run);
  std::this_thread::sleep_for(600ms);
  const std::vector<std::byte> large(std::size_t{8} << 20, std::byte{3});
  const std::array<std::span<const std::byte>, 1> parts{large};
  EXPECT_EQ(error_of([&, end = coordinator.get()] { end->send(parts, in(3s)); }).code(), ErrorCode::timeout);
  EXPECT_THAT(log.text(), HasSubstr("reads along, acknowledges nothing and so holds up this end"));
}

TEST(DdsIntruder, AnotherSecretIsRefusedOnBothSides) {
  const LogFile log;
  DdsOptions ours = options(), theirs = options();
  theirs.secret = "another secret, which is long enough";
  auto participant =
      std::async(std::launch::async, [&] { return error_of([&] { open_dds_participant(theirs, in(1s)); }); });
  const Error coordinator = error_of([&] { open_dds_coordinator(ours, in(1s)); });
  EXPECT_EQ(coordinator.code(), ErrorCode::timeout);
  EXPECT_THAT(coordinator.problem(), HasSubstr("refused was dem_server (pid "));
  EXPECT_THAT(coordinator.problem(), HasSubstr("its secret is not this run's"));
  EXPECT_THAT(participant.get().problem(), HasSubstr("its secret is not this run's"));
  EXPECT_THAT(log.text(), HasSubstr("its secret is not this run's"));
}

TEST(DdsIntruder, AnEndWithoutASecretIsToldThatOneIsAsked) {
  DdsOptions insecure = options();
  insecure.secret.clear();
  insecure.insecure = true;
  auto coordinator = std::async(std::launch::async,
                                [&] { return error_of([&] { open_dds_coordinator(options(), in(1s)); }); });
  const Error participant = error_of([&] { open_dds_participant(insecure, in(10s)); });
  EXPECT_EQ(participant.code(), ErrorCode::protocol);
  EXPECT_THAT(participant.problem(), HasSubstr("requires the run's secret, and this end was given none"));
  // It may have left before the coordinator heard of it.
  EXPECT_EQ(coordinator.get().code(), ErrorCode::timeout);
}

TEST(DdsIntruder, WithoutASecretARunIsRefusedUnlessItIsSaidToBeInsecure) {
  DdsOptions run = options();
  run.secret.clear();
  const Error e = error_of([&] { open_dds_coordinator(run, in(1s)); });
  EXPECT_EQ(e.code(), ErrorCode::usage);
  EXPECT_THAT(e.what(), HasSubstr("has no secret"));
  run.insecure = true;
  const auto [coordinator, participant] = open_pair(run);
  expect_works(*coordinator, *participant);
}

}  // namespace
}  // namespace tandem::protocol::test
