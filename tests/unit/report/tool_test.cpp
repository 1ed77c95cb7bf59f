#include "coordinator/report/tool.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <thread>

#include "common/interrupt.hpp"

namespace tandem::launch {
namespace {

class RunTool : public ::testing::Test {
 protected:
  Tool shell(const std::string& command) const {
    return {.program = "sh", .package = "dash", .arguments = {"-c", command}, .folder = folder_, .log = log_};
  }
  std::string output() const {
    std::ostringstream text;
    text << std::ifstream(log_).rdbuf();
    return text.str();
  }
  void TearDown() override { std::filesystem::remove(log_); }

  const std::filesystem::path folder_ = std::filesystem::temp_directory_path();
  const std::filesystem::path log_ = folder_ / ("tandem_tool_" + std::to_string(getpid()) + ".log");
};

TEST_F(RunTool, DoneLeavesNoLog) {
  EXPECT_TRUE(run_tool(shell("echo fine")));
  EXPECT_FALSE(std::filesystem::exists(log_));
}

TEST_F(RunTool, WorksInItsFolder) {
  EXPECT_TRUE(run_tool(shell("test \"$(pwd -P)\" = \"$(realpath /tmp)\"")));
}

TEST_F(RunTool, FailureKeepsWhatItSaid) {
  EXPECT_FALSE(run_tool(shell("echo out; echo err >&2; exit 3")));
  EXPECT_EQ(output(), "out\nerr\n");
}

TEST_F(RunTool, MissingToolIsNoDisaster) {
  Tool tool = shell("");
  tool.program = "no_such_tool_of_tandem";
  EXPECT_FALSE(run_tool(tool));
  EXPECT_FALSE(std::filesystem::exists(log_));
}

TEST_F(RunTool, EndlessToolIsStopped) {
  Tool tool = shell("exec sleep 1000");
  tool.patience = std::chrono::seconds(0);
  EXPECT_FALSE(run_tool(tool));
}

TEST_F(RunTool, AnInterruptKillsIt) {
  const InterruptGuard guard;
  kill(getpid(), SIGTERM);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(run_tool(shell("exec sleep 1000")));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
  EXPECT_FALSE(std::filesystem::exists(log_));
}

// It may still write its results.
TEST_F(RunTool, AnInterruptLetsARunEndInOrder) {
  const InterruptGuard guard;
  std::jthread user([this](const std::stop_token& end) {
    while (!end.stop_requested() && output() != "ready\n")
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    kill(getpid(), SIGTERM);
  });
  Tool tool = shell("trap 'sleep 0.1; echo done; exit 7' HUP; echo ready; while :; do sleep 0.02; done");
  tool.ends_in_order = true;
  const ToolEnd end = wait_for_tool(tool);
  EXPECT_TRUE(end.interrupted);
  EXPECT_FALSE(end.timed_out);
  EXPECT_EQ(end.status, 7);
  EXPECT_EQ(output(), "ready\ndone\n");
}

}  // namespace
}  // namespace tandem::launch
