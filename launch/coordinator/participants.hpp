// The solvers of a run and where they live: processes that this one started, servers started by hand, or
// threads.
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
  // Brings up the solvers that the scene needs. Logs of started servers go to `log`.
  Participants(const RunOptions& options, const scene::Scene& scene, const std::filesystem::path& log,
               protocol::Recorder* recorder);
  // Ends all that still runs, within a second.
  ~Participants();
  Participants(const Participants&) = delete;
  Participants& operator=(const Participants&) = delete;

  Solvers solvers() const;
  // Makes `error` known to all.
  void fail(const Error& error) noexcept;
  // The sentence about a server of ours that has ended although nobody told it to; waits so long for one to
  // end.
  std::optional<std::string> death(std::chrono::milliseconds patience);
  // After finish: waits for the servers to leave, at most a second; says who did not.
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
