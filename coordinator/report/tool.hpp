// Runs another program and waits for its end.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace tandem::launch {

struct Tool {
  std::string program;  // looked up on PATH unless it contains a slash
  std::string package;  // Debian package of the program
  std::vector<std::string> arguments;
  std::filesystem::path folder;       // working folder
  std::filesystem::path log;          // receives its output; removed after success
  std::chrono::seconds patience{60};  // limit after which it is stopped
  // What interrupted() does to it: it is killed; or it gets SIGHUP and is waited for, as a run that ends
  // after its window. The latter has a process group of its own, so that a Ctrl-C at the terminal is not its
  // second signal. Where this program is killed, the same signal reaches it.
  bool ends_in_order = false;
};

// How the program ended.
struct ToolEnd {
  bool started = false, timed_out = false, interrupted = false;
  int status = -1;  // exit status; -1: ended by `signal`
  int signal = 0;
};
ToolEnd wait_for_tool(const Tool& tool);

// Returns true when it ended with status 0; otherwise a warning gives the reason and the remedy, but where it
// was interrupted.
bool run_tool(const Tool& tool);

}  // namespace tandem::launch
