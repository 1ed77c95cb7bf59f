// A spring-damper along the line between two points of links, and its derivatives.
#pragma once

#include "mbd_server/kinematics/kinematics.hpp"

namespace tandem::mbd {

struct SpringForce {
  Vector3d p_a, p_b;    // ends [m]
  Vector3d on_b;        // force on b; a gets the opposite [N]
  Matrix3d d_distance;  // derivative of on_b with respect to p_b - p_a [N/m]
  Matrix3d d_velocity;  // derivative of on_b with respect to the velocity of p_b relative to p_a [N s/m]
  double energy = 0;    // stored in the spring [J]
};

// The tension elastic(L - length) + viscous(dL/dt) pulls the ends together. Throws Error{numerics} where the
// points coincide, as the line has no direction there.
SpringForce evaluate(const Spring& spring, const std::vector<LinkMotion>& links);

}  // namespace tandem::mbd
