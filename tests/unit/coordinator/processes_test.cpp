#include "coordinator/start/processes.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

using namespace std::chrono_literals;

// Programs are searched for in the folder of the executable; a relative path leads from there to the system's
// programs.
std::string beside(const std::string& program) {
  return std::filesystem::relative(program, program_folder()).string();
}

TEST(Process, TellsTheExitStatus) {
  Process process(beside("/bin/sh"), {"-c", "exit 3"}, {}, {});
  EXPECT_EQ(process.ending(5s), "exited with status 3");
  EXPECT_EQ(process.ending(0ms), "exited with status 3") << "asked again";
}

TEST(Process, TellsTheSignal) {
  Process process(beside("/bin/sleep"), {"60"}, {}, {});
  EXPECT_FALSE(process.ending(0ms));
  kill(process.pid(), SIGKILL);
  EXPECT_EQ(process.ending(5s), "was killed by signal 9 (Killed)");
}

TEST(Process, OutlivesSignalsThatReachAllProgramsOfARun) {
  Process process(beside("/bin/sleep"), {"60"}, {}, {});
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) kill(process.pid(), signal);
  EXPECT_FALSE(process.ending(20ms));
}

TEST(Process, IsNotLeftBehind) {
  int pid = 0;
  {
    Process process(beside("/bin/sleep"), {"60"}, {}, {});
    pid = process.pid();
  }
  EXPECT_EQ(kill(pid, 0), -1);
}

TEST(Process, IsNotLeftBehindWhenStopped) {
  int pid = 0;
  {
    Process process(beside("/bin/sleep"), {"60"}, {}, {});
    pid = process.pid();
    kill(pid, SIGSTOP);
  }
  EXPECT_EQ(kill(pid, 0), -1);
}

TEST(Process, TellsThatItIsStopped) {
  Process process(beside("/bin/sleep"), {"60"}, {}, {});
  EXPECT_FALSE(process.stopped());
  kill(process.pid(), SIGSTOP);
  const auto deadline = std::chrono::steady_clock::now() + 5s;
  while (!process.stopped() && std::chrono::steady_clock::now() < deadline) EXPECT_FALSE(process.ending(1ms));
  EXPECT_TRUE(process.stopped());
  EXPECT_TRUE(process.stopped()) << "asked again";
  kill(process.pid(), SIGKILL);
  EXPECT_EQ(process.ending(5s), "was killed by signal 9 (Killed)");
  EXPECT_FALSE(process.stopped());
}

TEST(Process, AMissingProgramIsNamed) {
  try {
    Process process("no_such_server", {}, {}, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::resource);
    EXPECT_NE(std::string(error.what()).find("no_such_server: cannot be started: No such file"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace tandem::launch
