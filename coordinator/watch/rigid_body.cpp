#include "coordinator/watch/rigid_body.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::launch {

double gyration(const scene::Body& body) {
  return std::sqrt(std::max({body.inertia[0], body.inertia[1], body.inertia[2]}) / body.mass);
}

Vec3d inertia_times(const scene::Body& body, const Quat& orientation, Vec3d vector) {
  const auto& [xx, yy, zz, xy, xz, yz] = body.inertia;
  const Vec3d w = orientation.conjugate().rotate(vector);
  return orientation.rotate(
      {xx * w.x + xy * w.y + xz * w.z, xy * w.x + yy * w.y + yz * w.z, xz * w.x + yz * w.y + zz * w.z});
}

Vec3d angular_momentum(const scene::Body& body, const Pose& pose, const Twist& twist) {
  return inertia_times(body, pose.q_WB, twist.w_WB);
}

double kinetic_energy(const scene::Body& body, const Pose& pose, const Twist& twist) {
  return 0.5 * body.mass * norm2(twist.v_WB) + 0.5 * dot(twist.w_WB, angular_momentum(body, pose, twist));
}

}  // namespace tandem::launch
