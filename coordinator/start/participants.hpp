// The solvers of a run and where they run: processes started here, servers started by the user, or threads.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/scene/options.hpp"
#include "coordinator/schemes/schemes.hpp"
#include "coordinator/start/processes.hpp"
#include "coordinator/start/server_command.hpp"
#include "protocol/remote.hpp"

namespace tandem::launch {

class Participants {
 public:
  // Starts the solvers that the scene needs, ours or those of `foreign`. Logs of started servers go to `log`.
  Participants(const RunOptions& options, const scene::Scene& scene, const ForeignServers& foreign,
               const std::filesystem::path& log, protocol::FrameSink* recorder);
  // Ends all that are still running, within a second.
  ~Participants();
  Participants(const Participants&) = delete;
  Participants& operator=(const Participants&) = delete;

  Solvers solvers() const;
  // The first window begins: an interrupt no longer ends a wait for a participant, because the window is
  // completed.
  void begin() { begun_ = true; }
  // Sends `error` to all participants.
  void fail(const Error& error) noexcept;
  struct Death {
    std::string sentence;    // "mbd_server 'my_solver' (pid 1234) exited with status 3"
    std::string last_words;  // its last line in the log, of a foreign server; may be empty
  };
  // Waits up to `patience` for the unexpected end of a server that was started here.
  std::optional<Death> death(std::chrono::milliseconds patience);
  // From now on a server may leave with status 0.
  void expect_leaving() { may_leave_ = true; }
  // After finish: waits at most a second for each server to end; returns those that did not, or ended
  // otherwise than with status 0.
  struct Leaving {
    std::string program;  // "mbd_server 'my_solver' (pid 1234)"
    std::string ending;   // "exited with status 9"; empty where it has not ended
  };
  std::vector<Leaving> leave();

 private:
  struct Participant {
    protocol::Role role{};
    std::optional<Process> process;
    std::thread thread;
    std::future<int> thread_done;
    std::unique_ptr<protocol::Remote> remote;
    bool foreign = false;
  };

  std::string last_words(protocol::Role role) const;

  std::vector<std::unique_ptr<Participant>> participants_;
  std::filesystem::path log_;
  std::uintmax_t log_begin_ = 0;  // size of the log at the start
  bool begun_ = false, may_leave_ = false;
};

}  // namespace tandem::launch
