// Runs one participant over a channel until finish, failure or a dead coordinator: registers, checks every frame
// against the session table and every value for sense, calls the solver, answers. Returns the exit status.
#pragma once

#include <string>

#include "protocol/channel.hpp"
#include "protocol/participant/solver.hpp"

namespace tandem::protocol {

int serve(Channel& channel, MotionSolver& solver, const std::string& program);
int serve(Channel& channel, LoadSolver& solver, const std::string& program);

}  // namespace tandem::protocol
