// A server that this process started: spawned beside the executable, watched by pidfd, reaped, never left
// behind.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tandem::launch {

// Folder of the running executable, where its servers lie too.
std::filesystem::path program_folder();

class Process {
 public:
  // Starts `program` of program_folder(). `inherited` are the descriptors that stay open in it; its stderr is
  // added to `log` where that is given. It gets its own process group, so that a Ctrl-C at the terminal
  // reaches only the coordinator, which then ends the run in order. Error{resource} when it cannot be
  // started.
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
