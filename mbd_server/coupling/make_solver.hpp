// The multibody solver as a participant.
#pragma once

#include <memory>

#include "protocol/participant/solver.hpp"

namespace tandem::mbd {
std::unique_ptr<protocol::MotionSolver> make_solver();
}
