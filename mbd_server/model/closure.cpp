#include "mbd_server/model/closure.hpp"

#include <algorithm>

namespace tandem::mbd {

bool Closure::turns() const {
  return std::any_of(equations.begin(), equations.end(),
                     [](const Equation& e) { return mbd::turns(e.kind); });
}

bool Closure::turns_as_torque() const {
  return std::all_of(equations.begin(), equations.end(),
                     [](const Equation& e) { return !mbd::turns(e.kind) || e.kind == EquationKind::square; });
}

}  // namespace tandem::mbd
