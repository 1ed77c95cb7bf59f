// A program that this process started: a server beside the executable, or a controller. Watched by pidfd,
// reaped, never left behind.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tandem::launch {

// Folder of the running executable, where its servers lie too.
std::filesystem::path program_folder();

struct Command {
  std::string name;               // for messages
  std::filesystem::path program;  // path
  std::vector<std::string> arguments;
  std::vector<int> inherited;  // descriptors that stay open in it
  int in_out = -1;             // descriptor that becomes its stdin and stdout; -1: /dev/null and ours
  std::filesystem::path log;   // its stderr is added here; empty: ours
  int watched = -1;            // descriptor that becomes its descriptor 3; -1: none
};

class Process {
 public:
  // It gets its own process group, so that a Ctrl-C at the terminal reaches only the coordinator, which then
  // ends the run in order. Error{resource} when it cannot be started.
  explicit Process(const Command& command);
  // Starts `program` of program_folder().
  Process(const std::string& program, const std::vector<std::string>& arguments,
          const std::vector<int>& inherited, const std::filesystem::path& log);
  // Ends the process when it still runs: asks it first, insists after a quarter of a second.
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&&) = delete;

  // "mbd_server (pid 1234)"
  const std::string& name() const { return name_; }
  int pid() const { return pid_; }
  // How it ended, waiting for that at most `patience`: "was killed by signal 9 (Killed)", "exited with status
  // 3"; nothing while it runs.
  std::optional<std::string> ending(std::chrono::milliseconds patience);
  // Of a server that was told to finish.
  static constexpr const char* good_ending = "exited with status 0";

 private:
  std::string name_;
  int pid_ = -1;
  int pidfd_ = -1;
  std::optional<std::string> ending_;
};

}  // namespace tandem::launch
