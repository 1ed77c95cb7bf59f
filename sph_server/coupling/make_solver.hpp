// The solver of liquids without its class, for programs that run it in their own process.
#pragma once

#include <memory>

#include "protocol/participant/solver.hpp"

namespace tandem::sph {
std::unique_ptr<protocol::LoadSolver> make_solver();
}
