// Runs another program to its end.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace tandem::launch {

struct Tool {
  std::string program;  // looked up on PATH unless it holds a slash
  std::string package;  // Debian package that brings it
  std::vector<std::string> arguments;
  std::filesystem::path folder;       // working folder
  std::filesystem::path log;          // takes its output; removed when it has done well
  std::chrono::seconds patience{60};  // then it is stopped
};

// How it ended.
struct ToolEnd {
  bool started = false, timed_out = false;
  int status = -1;  // exit status; -1: ended by `signal`
  int signal = 0;
};
ToolEnd wait_for_tool(const Tool& tool);

// True when it ended with status 0; else a warning says why not, and what to do about it.
bool run_tool(const Tool& tool);

}  // namespace tandem::launch
