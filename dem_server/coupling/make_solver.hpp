// The particle solver as a participant.
#pragma once

#include <memory>

#include "protocol/participant/solver.hpp"

namespace tandem::dem {
std::unique_ptr<protocol::LoadSolver> make_solver();
}
