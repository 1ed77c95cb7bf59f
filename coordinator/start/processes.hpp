// A program started by this process: a server from the folder of the executable, or a controller. It is
// watched by pidfd, reaped, and always ended.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tandem::launch {

// Folder of the running executable, which also holds its servers.
std::filesystem::path program_folder();

struct Command {
  std::string name;               // for messages
  std::filesystem::path program;  // path
  std::vector<std::string> arguments;
  std::vector<int> inherited;  // descriptors that stay open in it
  // Descriptor for its stdin and stdout; -1: /dev/null, and the stdout of this process, or the log where it
  // is foreign and has one.
  int in_out = -1;
  std::filesystem::path log;          // its stderr is appended here; empty: stderr of this process
  int watched = -1;                   // descriptor that it gets as descriptor 3; -1: none
  bool foreign = false;               // not of tandem: it may be a script, whose children end with it
  std::filesystem::path python = {};  // folder of Python packages for it, after PYTHONPATH; empty: none
};

class Process {
 public:
  // The process gets its own process group, and holds SIGINT, SIGTERM and SIGHUP back: a Ctrl-C at the
  // terminal, and a signal that a batch system sends to all programs, reach only the coordinator, which then
  // ends the run in order. Throws Error{resource} when it cannot be started.
  explicit Process(const Command& command);
  // Starts `program` of program_folder().
  Process(const std::string& program, const std::vector<std::string>& arguments,
          const std::vector<int>& inherited, const std::filesystem::path& log);
  // Ends the process if it still runs: SIGTERM first, for those that take it, SIGKILL after a quarter of a
  // second.
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&&) = delete;

  // "mbd_server (pid 1234)", "mbd_server 'my_solver --fast' (pid 1234)"
  const std::string& name() const { return name_; }
  int pid() const { return pid_; }
  // Waits at most `patience` for its end and describes it: "was killed by signal 9 (Killed)", "exited with
  // status 3"; empty while it runs.
  std::optional<std::string> ending(std::chrono::milliseconds patience);
  // Ending of a server after finish.
  // Whether a signal has stopped it, so that it can neither speak nor end.
  bool stopped() const;
  static constexpr const char* good_ending = "exited with status 0";

 private:
  std::string name_;
  int pid_ = -1;
  int pidfd_ = -1;
  bool foreign_ = false;
  std::optional<std::string> ending_;
};

}  // namespace tandem::launch
