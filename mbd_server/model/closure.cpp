#include "mbd_server/model/closure.hpp"

#include <algorithm>

namespace tandem::mbd {

bool Closure::has_geometric_stiffness() const {
  return std::any_of(equations.begin(), equations.end(),
                     [](const Equation& e) { return mbd::rotates_with_links(e.kind); });
}

bool Closure::stiffness_is_torque() const {
  return std::all_of(equations.begin(), equations.end(), [](const Equation& e) {
    return !mbd::rotates_with_links(e.kind) || e.kind == EquationKind::square;
  });
}

}  // namespace tandem::mbd
