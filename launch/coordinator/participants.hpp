// The solvers of a run and where they run: processes started here, servers started by the user, or threads.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/scene/model.hpp"
#include "launch/coordinator/options.hpp"
#include "launch/coordinator/processes.hpp"
#include "launch/coordinator/schemes.hpp"
#include "protocol/remote.hpp"

namespace tandem::launch {

class Participants {
 public:
  // Starts the solvers that the scene needs. Logs of started servers go to `log`.
  Participants(const RunOptions& options, const scene::Scene& scene, const std::filesystem::path& log,
               protocol::FrameSink* recorder);
  // Ends all that are still running, within a second.
  ~Participants();
  Participants(const Participants&) = delete;
  Participants& operator=(const Participants&) = delete;

  Solvers solvers() const;
  // Sends `error` to all participants.
  void fail(const Error& error) noexcept;
  // Waits up to `patience` for the unexpected end of a server that was started here; returns a sentence
  // about it.
  std::optional<std::string> death(std::chrono::milliseconds patience);
  // After finish: waits at most a second for the servers to end; returns a sentence about those that did
  // not.
  std::optional<std::string> leave();

 private:
  struct Participant {
    protocol::Role role{};
    std::optional<Process> process;
    std::thread thread;
    std::future<int> thread_done;
    std::unique_ptr<protocol::Remote> remote;
  };

  const Participant* find(protocol::Role role) const;

  std::vector<std::unique_ptr<Participant>> participants_;
};

}  // namespace tandem::launch
