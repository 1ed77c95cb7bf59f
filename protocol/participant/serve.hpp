// Runs one participant over a channel until finish, failure or a dead coordinator: registers, checks every
// frame against the session table and every value for sense, calls the solver, answers. Returns the exit
// status. `window` is kept at the index of the window in hand, for whoever watches from another thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "protocol/channel.hpp"
#include "protocol/participant/solver.hpp"

namespace tandem::protocol {

int serve(Channel& channel, MotionSolver& solver, const std::string& program,
          std::atomic<std::uint64_t>* window = nullptr);
int serve(Channel& channel, LoadSolver& solver, const std::string& program,
          std::atomic<std::uint64_t>* window = nullptr);

}  // namespace tandem::protocol
