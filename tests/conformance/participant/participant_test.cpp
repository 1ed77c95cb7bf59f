#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <thread>

#include "protocol/facts.hpp"
#include "protocol/remote.hpp"
#include "protocol/shm/shm_channel.hpp"
#include "protocol/version.hpp"
#include "toy_solvers.hpp"

namespace tandem::protocol::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

std::string temporary(const std::string& name) {
  return (std::filesystem::temp_directory_path() / ("tandem_" + std::to_string(getpid()) + "_" + name))
      .string();
}

// A participant's process, with its log.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments, const std::vector<Fd>& inherited = {},
                   std::string log = temporary("participant.log"))
      : log_(std::move(log)) {
    std::vector<char*> argv{const_cast<char*>(TOY_PARTICIPANT)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    for (const Fd& fd : inherited) fcntl(fd.get(), F_SETFD, 0);
    const int file = open(log_.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    dup2(file, 2);
    dup2(file, 1);
    alarm(60);
    execv(argv[0], argv.data());
    _exit(127);
  }
  ~Process() {
    if (!status_) {
      ::kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    std::filesystem::remove(log_);
  }
  // Exit status, or minus the signal; nothing if it still runs.
  std::optional<int> wait(Clock::duration patience = 10s) {
    const Deadline deadline = Clock::now() + patience;
    for (int status = 0; !status_ && Clock::now() < deadline; std::this_thread::sleep_for(5ms))
      if (waitpid(pid_, &status, WNOHANG) == pid_)
        status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    return status_;
  }
  void signal(int number) const { ::kill(pid_, number); }
  std::string pid_text() const { return "(pid " + std::to_string(pid_) + ")"; }
  std::string log() const { return read(log_); }
  static std::string read(const std::string& file) {
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

 private:
  pid_t pid_ = -1;
  std::string log_;
  std::optional<int> status_;
};

std::unique_ptr<Remote> remote_of(std::unique_ptr<Channel> channel, const std::string& scene = {}) {
  auto remote = std::make_unique<Remote>(std::move(channel), Role::mbd, RunIdentity{1, 1});
  remote->register_peer(0, 10s);
  Configuration configuration;
  configuration.scene_text = scene;
  SolverFacts facts;
  decode_facts(Role::mbd, remote->configure(configuration).facts, facts);
  return remote;
}

void run_windows(Remote& remote, std::uint64_t from, std::uint64_t to) {
  LoadSet loads;
  for (std::uint64_t i = from; i < to; ++i) {
    remote.start_predict(window(i));
    remote.finish_motion();
    loads.window = window(i);
    remote.start_advance(loads);
    remote.finish_motion();
  }
}

TEST(Participant, StartedByItsCoordinatorGoesThroughARun) {
  Endpoint endpoint = create_shm("mbd_server");
  Process process(endpoint.server_arguments, endpoint.inherited);
  endpoint.inherited.clear();
  const auto remote = remote_of(std::move(endpoint.channel));
  EXPECT_EQ(remote->peer(), "mbd_server " + process.pid_text());
  run_windows(*remote, 0, 100);
  EXPECT_EQ(remote->finish().facts, R"({"windows": 1})");
  EXPECT_EQ(process.wait(), 0);
}

TEST(Participant, StartedByHandMeetsItsCoordinatorInEitherOrder) {
  const std::string name = "test-" + std::to_string(getpid());
  for (const bool server_first : {true, false}) {
    std::optional<Process> process;
    if (server_first) process.emplace(std::vector<std::string>{"--shm", name});
    std::jthread late([&] {
      if (server_first) return;
      std::this_thread::sleep_for(100ms);
      process.emplace(std::vector<std::string>{"--shm", name});
    });
    auto channel = connect_shm(name, "mbd_server", Clock::now() + 10s);
    late.join();
    const auto remote = remote_of(std::move(channel));
    EXPECT_EQ(remote->peer(), "mbd_server " + process->pid_text());
    run_windows(*remote, 0, 3);
    remote->finish();
    EXPECT_EQ(process->wait(), 0);
  }
}

TEST(Participant, NobodyUnderANameIsATimeoutThatSaysWhatToStart) {
  try {
    connect_shm("nobody-here", "dem_server", Clock::now() + 50ms);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::timeout);
    EXPECT_THAT(e.what(), HasSubstr("start dem_server --shm nobody-here"));
  }
}

TEST(Participant, KilledInARunIsNamedWithItsWindow) {
  for (const bool busy : {false, true}) {
    Endpoint endpoint = create_shm("mbd_server");
    Process process(endpoint.server_arguments, endpoint.inherited);
    endpoint.inherited.clear();
    const auto remote = remote_of(std::move(endpoint.channel), busy ? "slow" : "");
    if (!busy) run_windows(*remote, 0, 5);
    const std::uint64_t w = busy ? 0 : 5;
    if (busy) remote->start_predict(window(w));
    process.signal(SIGKILL);
    const auto begin = Clock::now();
    try {
      if (!busy) run_windows(*remote, w, w + 1);
      remote->finish_motion();
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::peer_lost);
      EXPECT_THAT(e.what(),
                  HasSubstr("mbd_server " + process.pid_text() + " died in window " + std::to_string(w)));
    }
    EXPECT_LT(Clock::now() - begin, 1s);
  }
}

// ---- the coordinator is killed: it is a child of the test, and the participant, its child, comes to the
// test.

enum class Moment { before_attach, between_windows, while_the_solver_works };

class CoordinatorKilled : public testing::TestWithParam<Moment> {};

TEST_P(CoordinatorKilled, LeavesNoParticipantBehind) {
  const Moment moment = GetParam();
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const std::string log = temporary("orphan.log");
  std::array<int, 2> pipe_ends{};
  ASSERT_EQ(pipe2(pipe_ends.data(), O_CLOEXEC), 0);
  const pid_t coordinator = fork();
  if (coordinator == 0) {
    alarm(60);
    Endpoint endpoint = create_shm("mbd_server");
    auto* process = new Process(endpoint.server_arguments, endpoint.inherited, log);
    endpoint.inherited.clear();
    static_cast<void>(process);  // outlives this coordinator
    if (moment != Moment::before_attach) {
      auto remote = remote_of(std::move(endpoint.channel), moment == Moment::between_windows ? "" : "slow");
      if (moment == Moment::between_windows)
        run_windows(*remote, 0, 7);
      else
        remote->start_predict(window(0));
      static_cast<void>(write(pipe_ends[1], "x", 1));
      std::this_thread::sleep_for(1min);
    }
    static_cast<void>(write(pipe_ends[1], "x", 1));
    std::this_thread::sleep_for(1min);
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(pipe_ends[0], &byte, 1), 1);
  if (moment == Moment::while_the_solver_works) std::this_thread::sleep_for(100ms);
  kill(coordinator, SIGKILL);
  const auto begin = Clock::now();
  ASSERT_EQ(waitpid(coordinator, nullptr, 0), coordinator);
  int status = 0;
  ASSERT_GT(waitpid(-1, &status, 0), 0);
  EXPECT_LT(Clock::now() - begin, 1s);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), exit_status(ErrorCode::peer_lost));
  const std::string who = "coordinator (pid " + std::to_string(coordinator) + ") died";
  const std::string said = Process::read(log);
  if (moment == Moment::between_windows)
    EXPECT_THAT(said, HasSubstr(who + " in window 7"));
  else if (moment == Moment::while_the_solver_works)
    EXPECT_THAT(said, HasSubstr("coordinator (pid " + std::to_string(coordinator) +
                                ") was lost in window 0, while this solver was at work"));
  else
    EXPECT_THAT(said, AllOf(HasSubstr("coordinator"), HasSubstr("died")));
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm"))
    EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr("tandem")));
  std::filesystem::remove(log);
  for (const int end : pipe_ends) close(end);
}

INSTANTIATE_TEST_SUITE_P(Moments, CoordinatorKilled,
                         testing::Values(Moment::before_attach, Moment::between_windows,
                                         Moment::while_the_solver_works));

// ---- command line and signals

TEST(ParticipantCommand, WrongUseIsStatus2WithASentence) {
  const auto run = [](const std::vector<std::string>& arguments) {
    Process process(arguments);
    const auto status = process.wait();
    return std::pair(status.value_or(-99), process.log());
  };
  using testing::Pair;
  EXPECT_THAT(run({}), Pair(2, HasSubstr("--shm NAME, --stream - or --dds RUN")));
  EXPECT_THAT(run({"--shm", "a/b"}), Pair(2, HasSubstr("\"a/b\" is no name for a channel")));
  EXPECT_THAT(run({"--shm", "fd:99"}), Pair(2, HasSubstr("no open descriptor")));
  EXPECT_THAT(run({"--shm", "fd:1"}), Pair(2, HasSubstr("no socket of a coordinator")));
  EXPECT_THAT(run({"--shm", "x", "--dds", "y"}), Pair(2, HasSubstr("--dds")));
  EXPECT_THAT(run({"--shm", "x", "--log-level", "loud"}), Pair(2, HasSubstr("loud")));
  const std::string version =
      "protocol " + std::to_string(protocol_version.major) + "." + std::to_string(protocol_version.minor);
  EXPECT_THAT(run({"--version"}), Pair(0, AllOf(HasSubstr("mbd_server"), HasSubstr(version))));
}

TEST(ParticipantCommand, ATakenNameIsStatus2) {
  const std::string name = "taken-" + std::to_string(getpid());
  Process first({"--shm", name});
  while (first.log().find("waiting for a coordinator") == std::string::npos) std::this_thread::sleep_for(5ms);
  std::this_thread::sleep_for(50ms);
  Process second({"--shm", name}, {}, temporary("second.log"));
  EXPECT_EQ(second.wait(), 2);
  EXPECT_THAT(second.log(), HasSubstr("another server already waits under the name"));
}

// The coordinator ends the run in order after the first; see outlive_first_signals().
TEST(ParticipantCommand, AStartedParticipantIgnoresCtrlCAndObeysTheSecondSigterm) {
  Endpoint endpoint = create_shm("mbd_server");
  Process process(endpoint.server_arguments, endpoint.inherited);
  endpoint.inherited.clear();
  const auto remote = remote_of(std::move(endpoint.channel));
  process.signal(SIGINT);
  run_windows(*remote, 0, 10);
  process.signal(SIGTERM);
  run_windows(*remote, 10, 20);
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait(), -SIGTERM);
  EXPECT_THROW(run_windows(*remote, 20, 21), Error);
}

}  // namespace
}  // namespace tandem::protocol::test
