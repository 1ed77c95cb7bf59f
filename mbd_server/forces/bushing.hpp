// A bushing between two links, and its derivatives.
#pragma once

#include "mbd_server/forces/force_element.hpp"

namespace tandem::mbd {

// See scene::Bushing; the frames coincide with the world's axes at zero coordinates.
struct BushingOnLinks {
  std::string name;
  PointOnBody a, b;
  Matrix6d stiffness, damping;
  int account = none;
};

struct BushingForce {
  Vector3d p;     // point of application: point b [m]
  Vector6d on_b;  // force [N] and torque [N m] on b at p, world axes; a gets the opposite at the same point
  // Change of on_b, less its rotation with link a, per displacement and rate of b relative to a: rotation
  // [rad] and displacement of p [m], angular velocity and velocity of p; world axes.
  Matrix6d d_displacement, d_velocity;
  double energy = 0;  // [J]
};
// Throws Error{numerics} at a relative rotation by pi, whose rotation vector is not unique.
BushingForce evaluate(const BushingOnLinks& bushing, const std::vector<LinkMotion>& links);

std::shared_ptr<const ForceElement> make_force(BushingOnLinks bushing);

}  // namespace tandem::mbd
