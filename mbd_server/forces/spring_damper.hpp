// A spring-damper along the line between two points of links, see scene::SpringDamper.
#pragma once

#include "mbd_server/forces/force_element.hpp"
#include "mbd_server/model/force_law.hpp"

namespace tandem::mbd {

struct Spring {
  std::string name;
  PointOnBody a, b;
  ForceLaw elastic, viscous;  // over the elongation [m] and its rate [m/s]: tension [N]
  double length = 0;          // [m]
  int account = none;         // see Model::accounts
};

// The tension elastic(L - length) + viscous(dL/dt) pulls the ends together. Throws Error{numerics} where the
// points coincide, as the line has no direction there.
SpringForce evaluate(const Spring& spring, const std::vector<LinkMotion>& links);

std::shared_ptr<const ForceElement> make_force(Spring spring);

}  // namespace tandem::mbd
