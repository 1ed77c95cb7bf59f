// Solvers of the protocol made from the tables of functions of the C interface.
#pragma once

#include <memory>

#include "participant/include/tandem/participant.h"
#include "protocol/participant/solver.hpp"

namespace tandem::participant {

// Error{usage} for a table that lacks a function which its capabilities promise, or has another size. The
// table and `self` must outlive the solver.
std::unique_ptr<protocol::MotionSolver> make_motion_solver(const tandem_motion_solver& table, void* self,
                                                           std::string program);
// `role`: dem or sph.
std::unique_ptr<protocol::LoadSolver> make_load_solver(const tandem_load_solver& table, void* self,
                                                       std::string program, protocol::Role role);

}  // namespace tandem::participant
