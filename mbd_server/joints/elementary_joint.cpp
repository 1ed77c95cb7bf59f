#include "mbd_server/joints/elementary_joint.hpp"

#include <cmath>

namespace tandem::mbd {
namespace {

Quaterniond quaternion(const double* q) {
  return {q[0], q[1], q[2], q[3]};
}

}  // namespace

JointPose joint_pose(Elementary kind, const Vector3d& axis, double pitch, const double* q) {
  JointPose pose;
  switch (kind) {
    case Elementary::revolute:
    case Elementary::screw: {
      const Vector3d v = std::sin(*q / 2) * axis;
      pose.rotation = {std::cos(*q / 2), v.x(), v.y(), v.z()};
      if (kind == Elementary::screw) pose.displacement = pitch * *q * axis;
      break;
    }
    case Elementary::prismatic:
      pose.displacement = *q * axis;
      break;
    case Elementary::translation:
      pose.displacement = {q[0], q[1], q[2]};
      break;
    case Elementary::spherical:
      pose.rotation = quaternion(q);
      break;
  }
  return pose;
}

int motion_subspace(Elementary kind, const Vector3d& axis, double pitch, const Matrix3d& R, const Vector3d& p,
                    Eigen::Matrix<double, 6, 3>& S) {
  switch (kind) {
    case Elementary::revolute: {
      const Vector3d n = R * axis;
      S.col(0) = spatial(n, p.cross(n));
      return 1;
    }
    case Elementary::screw: {
      const Vector3d n = R * axis;
      S.col(0) = spatial(n, p.cross(n) + pitch * n);
      return 1;
    }
    case Elementary::prismatic:
      S.col(0) = spatial(Vector3d::Zero(), R * axis);
      return 1;
    case Elementary::translation:
      S.topRows<3>().setZero();
      S.bottomRows<3>() = R;
      return 3;
    case Elementary::spherical:
      S.topRows<3>() = R;
      S.bottomRows<3>() = skew(p) * R;
      return 3;
  }
  return 0;
}

void move(Elementary kind, const double* q0, const double* x, double* q1) {
  if (kind != Elementary::spherical) {
    for (int k = 0; k < freedoms(kind); ++k) q1[k] = q0[k] + x[k];
    return;
  }
  const Quat turned = (Quat{q0[0], q0[1], q0[2], q0[3]} * exp(Vec3d{x[0], x[1], x[2]})).normalized();
  q1[0] = turned.w, q1[1] = turned.x, q1[2] = turned.y, q1[3] = turned.z;
}

void difference(Elementary kind, const double* q0, const double* q1, double* x) {
  if (kind != Elementary::spherical) {
    for (int k = 0; k < freedoms(kind); ++k) x[k] = q1[k] - q0[k];
    return;
  }
  const Vec3d turn =
      rotation_vector(Quat{q0[0], q0[1], q0[2], q0[3]}.conjugate() * Quat{q1[0], q1[1], q1[2], q1[3]});
  x[0] = turn.x, x[1] = turn.y, x[2] = turn.z;
}

// T(x) = 1 - (1 - cos a)/a^2 x~ + (a - sin a)/a^3 x~ x~ with a = |x| (Iserles et al., Lie-group methods,
// 2000).
Matrix3d tangent_operator(const Vector3d& x) {
  const double a2 = x.squaredNorm(), a = std::sqrt(a2);
  // Below 1e-2 the quotients lose digits, and three terms of their series are exact to round-off.
  const bool small = a < 1e-2;
  const double s1 = small ? 0.5 - a2 / 24 + a2 * a2 / 720 : (1 - std::cos(a)) / a2;
  const double s2 = small ? 1.0 / 6 - a2 / 120 + a2 * a2 / 5040 : (a - std::sin(a)) / (a2 * a);
  const Matrix3d X = skew(x);
  return Matrix3d::Identity() - s1 * X + s2 * X * X;
}

// 1 + x~/2 + (1 - a/2 cot(a/2))/a^2 x~ x~: dexp^-1 of [MuntheKaas1998], for increments on the right.
Matrix3d inverse_tangent_operator(const Vector3d& x) {
  const double a2 = x.squaredNorm(), a = std::sqrt(a2);
  const bool small = a < 1e-2;  // as above
  const double s = small ? 1.0 / 12 + a2 / 720 + a2 * a2 / 30240 : (1 - 0.5 * a / std::tan(0.5 * a)) / a2;
  const Matrix3d X = skew(x);
  return Matrix3d::Identity() + 0.5 * X + s * X * X;
}

}  // namespace tandem::mbd
