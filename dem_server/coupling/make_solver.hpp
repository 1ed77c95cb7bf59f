// The particle solver as a participant.
#pragma once

#include <memory>

#include "particles/base/ranks.hpp"
#include "protocol/participant/solver.hpp"

namespace tandem::dem {
std::unique_ptr<protocol::LoadSolver> make_solver();
// That of one of several ranks (coupling/ranked_solver.hpp).
std::unique_ptr<protocol::LoadSolver> make_solver_of_rank(particles::Ranks& ranks);
}  // namespace tandem::dem
