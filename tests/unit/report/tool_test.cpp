#include "launch/report/tool.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

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

}  // namespace
}  // namespace tandem::launch
