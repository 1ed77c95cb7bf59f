// Runs one participant over a channel until finish, failure or the loss of the coordinator: registers, checks
// every frame against the session table and every value, calls the solver, answers. Returns the exit status.
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
  // Updated to the index of the present window, for readers in other threads.
  std::atomic<std::uint64_t>* window = nullptr;
  // Where states may be written and read; null: anywhere the coordinator requests, for a solver in its
  // process.
  const StateFolders* folders = nullptr;
  // Longest wait for the next order. The coordinator may be busy with the other participant, or with its
  // results, for a long time.
  std::chrono::milliseconds patience = std::chrono::hours(1);
};

int serve(Channel& channel, MotionSolver& solver, const std::string& program,
          const ServeOptions& options = {});
int serve(Channel& channel, LoadSolver& solver, const std::string& program, const ServeOptions& options = {});

}  // namespace tandem::protocol
