// Somebody who sees and sends packets on the network: what was on the wire comes again, as it was and with
// changed bits, under the addresses and numbers of the ends. In a network of its own, so that nobody else is
// hit.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <net/if.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/wait.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "common/log.hpp"
#include "ends.hpp"
#include "launch/keys/keys.hpp"
#include "protocol/dds/cyclone_log.hpp"
#include "wiretap.hpp"

namespace tandem::protocol::test {
namespace {

bool enter_own_network() {
  if (unshare(CLONE_NEWNET) != 0) return false;
  const Fd control(::socket(AF_INET, SOCK_DGRAM, 0));
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = IFF_UP | IFF_RUNNING;
  return ioctl(control.get(), SIOCSIFFLAGS, &request) == 0;
}

// Sends what it has seen again until it is told to stop; `changed`: with one to three changed bits.
std::uint64_t disturb(const Wiretap& tap, bool changed, const std::atomic<bool>& stop) {
  const Fd out(::socket(AF_INET, SOCK_DGRAM, 0));
  std::mt19937_64 random(7);
  std::vector<std::vector<char>> seen;
  std::uint64_t sent = 0;
  while (!stop) {
    // What we send ourselves comes by as well; the oldest make room.
    for (auto& packet : tap.packets(20))
      if (seen.size() < 500)
        seen.push_back(std::move(packet));
      else
        seen[random() % seen.size()] = std::move(packet);
    if (seen.empty()) continue;
    auto packet = seen[random() % seen.size()];
    udphdr head{};
    std::memcpy(&head, packet.data(), sizeof head);
    if (changed)
      for (std::uint64_t i = 0; i <= random() % 3 && packet.size() > sizeof head; ++i)
        packet[sizeof head + random() % (packet.size() - sizeof head)] ^=
            static_cast<char>(1 << random() % 8);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = head.dest;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (sendto(out.get(), packet.data() + sizeof head, packet.size() - sizeof head, 0,
               reinterpret_cast<const sockaddr*>(&to), sizeof to) > 0)
      ++sent;
    if (sent % 20 == 0) std::this_thread::sleep_for(1ms);
  }
  return sent;
}

enum class Outcome { undisturbed = 10, ended = 11, wrong = 12, no_network = 13, idle = 14, talkative = 15 };

// A pair that talks for a second under disturbance.
Outcome talk_under_disturbance(const DdsOptions& run, bool changed) {
  if (!enter_own_network()) return Outcome::no_network;
  const Wiretap tap;
  if (!tap.usable()) return Outcome::no_network;
  // Cyclone says of each broken packet what is wrong with it.
  const std::filesystem::path log_file =
      std::filesystem::temp_directory_path() / ("tandem_packets_" + std::to_string(getpid()));
  log::setup("test", "info", log_file);
  const auto [coordinator, participant] = open_pair(run);
  std::atomic<bool> stop = false;
  std::uint64_t sent = 0;
  std::jthread disturber([&] { sent = disturb(tap, changed, stop); });
  Outcome outcome = Outcome::undisturbed;
  const Deadline end = in(1s);
  try {
    for (std::uint8_t i = 0; Clock::now() < end; ++i) {
      const std::vector<std::byte> bytes(1 + 997 * i, std::byte{i});
      send(*coordinator, bytes);
      if (receive(*participant, 2s) != bytes) outcome = Outcome::wrong;
      send(*participant, bytes);
      if (receive(*coordinator, 2s) != bytes) outcome = Outcome::wrong;
    }
  } catch (const Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    outcome = Outcome::ended;
  }
  stop = true;
  disturber.join();
  std::ifstream log(log_file);
  std::string line;
  unsigned lines = 0;
  while (std::getline(log, line)) lines += line.find("Cyclone DDS: ") != std::string::npos;
  std::filesystem::remove(log_file);
  std::printf("%lu packets sent again, of which Cyclone DDS says %u lines\n",
              static_cast<unsigned long>(sent), lines);
  std::fflush(stdout);
  if (lines > 3 * dds::LineLimit::most) return Outcome::talkative;
  return sent < 100 ? Outcome::idle : outcome;
}

TEST(DdsLog, LinesOfCycloneAreLimitedAndThoseLeftOutCounted) {
  using Fate = dds::LineLimit::Fate;
  dds::LineLimit limit;
  const auto now = dds::LineLimit::Time(1h);
  for (unsigned i = 1; i < dds::LineLimit::most; ++i) EXPECT_EQ(limit.judge(now), Fate::written);
  EXPECT_EQ(limit.judge(now), Fate::last_of_span);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(limit.judge(now + 9s), Fate::left_out);
  EXPECT_EQ(limit.judge(now + 10s), Fate::written);
  EXPECT_EQ(limit.take_left_out(), 1000u);
  EXPECT_EQ(limit.take_left_out(), 0u);
}

int outcome_of(const DdsOptions& run, bool changed) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    int outcome = 1;
    try {
      outcome = static_cast<int>(talk_under_disturbance(run, changed));
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s\n", e.what());
    }
    _exit(outcome);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

class DdsPackets : public testing::TestWithParam<bool> {};

TEST_P(DdsPackets, ThatComeAgainDoNoHarm) {
  const bool with_certificates = GetParam();
  const auto folder = std::filesystem::temp_directory_path() / ("tandem_packets_" + std::to_string(getpid()));
  DdsOptions run = options();
  run.run = "packets";
  if (with_certificates) {
    launch::write_certificates(folder, 1);
    run.certificates = folder;
  }
  const int as_they_were = outcome_of(run, false), changed = outcome_of(run, true);
  std::filesystem::remove_all(folder);
  if (as_they_were == static_cast<int>(Outcome::no_network)) GTEST_SKIP() << "no network of our own";
  EXPECT_EQ(as_they_were, static_cast<int>(Outcome::undisturbed));
  if (with_certificates)
    EXPECT_EQ(changed, static_cast<int>(Outcome::undisturbed));
  else
    EXPECT_THAT(changed,
                testing::AnyOf(static_cast<int>(Outcome::undisturbed), static_cast<int>(Outcome::ended)));
}

INSTANTIATE_TEST_SUITE_P(Protection, DdsPackets, testing::Bool(),
                         [](const auto& with) { return with.param ? "Certificates" : "Secret"; });

}  // namespace
}  // namespace tandem::protocol::test
