// Rotations for host and device: unit quaternions (w, x, y, z) and 3x3 matrices.
// R_AB and q_AB transform vectors from frame B to frame A: v_A = R_AB v_B.
#pragma once

#include "common/math/vec3.hpp"

namespace tandem {

template <class T>
struct Mat3 {
  Vec3<T> row[3]{};  // rows
  TANDEM_HD friend constexpr Vec3<T> operator*(const Mat3& m, Vec3<T> v) {
    return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)};
  }
  // transpose(m) * v
  TANDEM_HD constexpr Vec3<T> transpose_times(Vec3<T> v) const {
    return v.x * row[0] + v.y * row[1] + v.z * row[2];
  }
  TANDEM_HD static constexpr Mat3 identity() { return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}; }
  friend constexpr bool operator==(const Mat3&, const Mat3&) = default;
};
using Mat3d = Mat3<double>;

struct Quat {
  double w = 1, x = 0, y = 0, z = 0;

  TANDEM_HD friend constexpr Quat operator*(Quat a, Quat b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
  TANDEM_HD constexpr Quat conjugate() const { return {w, -x, -y, -z}; }
  TANDEM_HD constexpr double norm2() const { return w * w + x * x + y * y + z * z; }
  TANDEM_HD constexpr Mat3d matrix() const {
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  }
  TANDEM_HD constexpr Vec3d rotate(Vec3d v) const {
    const Vec3d u{x, y, z};
    const Vec3d t = 2.0 * cross(u, v);
    return v + w * t + cross(u, t);
  }
  Quat normalized() const {
    const double s = 1 / std::sqrt(norm2());
    return {s * w, s * x, s * y, s * z};
  }
  friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

// exp of the rotation vector phi [rad]: the unit quaternion of a rotation by |phi| about phi.
Quat exp(Vec3d phi);
// Rotation vector of q, |phi| <= pi.
Vec3d rotation_vector(Quat q);

// Pose of body frame B (origin at the centre of mass) in the world W.
struct Pose {
  Vec3d p_WB;  // position of B's origin [m]
  Quat q_WB;   // orientation [-]
};

// Velocity of B in W, world axes.
struct Twist {
  Vec3d v_WB;  // velocity of B's origin [m/s]
  Vec3d w_WB;  // angular velocity [rad/s]
};

// Force and torque about B's origin, world axes.
struct Wrench {
  Vec3d force;   // [N]
  Vec3d torque;  // [N m]
};

}  // namespace tandem
