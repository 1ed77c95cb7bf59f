// Runs one participant over a channel until finish, failure or a dead coordinator: registers, checks every
// frame against the session table and every value for sense, calls the solver, answers. Returns the exit
// status.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

#include "protocol/channel.hpp"
#include "protocol/participant/solver.hpp"
#include "protocol/participant/state_folders.hpp"

namespace tandem::protocol {

struct ServeOptions {
  // Kept at the index of the window in hand, for whoever watches from another thread.
  std::atomic<std::uint64_t>* window = nullptr;
  // Where states may be written and read; null: wherever the coordinator says, for a solver in its process.
  const StateFolders* folders = nullptr;
  // Longest wait for the next order. A coordinator that lives may be busy with the other participant, or with
  // its results, for long.
  std::chrono::milliseconds patience = std::chrono::hours(1);
};

int serve(Channel& channel, MotionSolver& solver, const std::string& program,
          const ServeOptions& options = {});
int serve(Channel& channel, LoadSolver& solver, const std::string& program, const ServeOptions& options = {});

}  // namespace tandem::protocol
