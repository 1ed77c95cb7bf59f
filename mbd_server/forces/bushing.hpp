// A bushing between two links, and its derivatives.
#pragma once

#include "mbd_server/kinematics/kinematics.hpp"

namespace tandem::mbd {

struct BushingForce {
  Vector3d p;     // where it acts: point b [m]
  Vector6d on_b;  // force [N], torque [N m] on b at p, world axes; on a it is the opposite at the same place
  // Change of on_b, less its turning with link a, per displacement and rate of b relative to a: rotation
  // [rad] and displacement of p [m], angular velocity and velocity of p; world axes.
  Matrix6d d_displacement, d_velocity;
  double energy = 0;  // [J]
};
// A relative rotation of half a turn has no rotation vector: Error{numerics}.
BushingForce evaluate(const BushingOnLinks& bushing, const std::vector<LinkMotion>& links);

}  // namespace tandem::mbd
