// Spatial (six-dimensional) vectors of rigid-body mechanics, all in world axes about the world's origin O.
//
// Motion [w; v]: angular velocity, and velocity of the body-fixed point that coincides with O.
// Force  [n; f]: moment about O, and force.
// One common frame makes every sum over bodies a plain sum and every derivative one cross product
// (docs/mbd_equations.md); its cost is a loss of (distance from O / size of the body)^2 in the last digits.
// Notation: [Featherstone2008], chapter 2.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/math/rotation.hpp"

namespace tandem::mbd {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// ---- conversions from and to common/math

inline Vector3d to_eigen(Vec3d v) {
  return {v.x, v.y, v.z};
}
inline Vec3d to_vec3(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
inline Quaterniond to_eigen(const Quat& q) {
  return {q.w, q.x, q.y, q.z};
}
inline Quat to_quat(const Quaterniond& q) {
  return Quat{q.w(), q.x(), q.y(), q.z()}.normalized();
}

// ---- three-vectors

// skew(a) b = a x b
inline Matrix3d skew(const Vector3d& a) {
  Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

// ---- spatial vectors

inline Vector6d spatial(const Vector3d& top, const Vector3d& bottom) {
  return Vector6d{{top[0], top[1], top[2], bottom[0], bottom[1], bottom[2]}};
}

// Velocity that motion V gives to the point p.
inline Vector3d at_point(const Vector6d& V, const Vector3d& p) {
  return V.tail<3>() + V.head<3>().cross(p);
}

// Matrix of psi -> displacement of the point p.
inline Eigen::Matrix<double, 3, 6> at_point_matrix(const Vector3d& p) {
  Eigen::Matrix<double, 3, 6> m;
  m << -skew(p), Matrix3d::Identity();
  return m;
}

// Wrench of the force f at point p and an additional torque.
inline Vector6d wrench_at(const Vector3d& p, const Vector3d& f, const Vector3d& torque = Vector3d::Zero()) {
  return spatial(torque + p.cross(f), f);
}

// V x X: rate of a motion vector X that is fixed in a body with the velocity V. This one and those below are
// written out, since every link needs them several times in every evaluation; Eigen's comma initialiser of a
// column is not inlined.
inline Vector6d cross_motion(const Vector6d& V, const Vector6d& X) {
  return Vector6d{{V[1] * X[2] - V[2] * X[1], V[2] * X[0] - V[0] * X[2], V[0] * X[1] - V[1] * X[0],
                   V[4] * X[2] - V[5] * X[1] + V[1] * X[5] - V[2] * X[4],
                   V[5] * X[0] - V[3] * X[2] + V[2] * X[3] - V[0] * X[5],
                   V[3] * X[1] - V[4] * X[0] + V[0] * X[4] - V[1] * X[3]}};
}

// V x* F: rate of a force vector F that is fixed in a body with the velocity V.
inline Vector6d cross_force(const Vector6d& V, const Vector6d& F) {
  return Vector6d{{V[1] * F[2] - V[2] * F[1] + V[4] * F[5] - V[5] * F[4],
                   V[2] * F[0] - V[0] * F[2] + V[5] * F[3] - V[3] * F[5],
                   V[0] * F[1] - V[1] * F[0] + V[3] * F[4] - V[4] * F[3], V[1] * F[5] - V[2] * F[4],
                   V[2] * F[3] - V[0] * F[5], V[0] * F[4] - V[1] * F[3]}};
}

// Inertia of mass m, centre of mass c, inertia J about c (world axes): [J - m c~ c~, m c~; -m c~, m]. Written
// out, since it is computed for every link in every evaluation of the equation of motion.
inline Matrix6d spatial_inertia(double m, const Vector3d& c, const Matrix3d& J) {
  const double x = c[0], y = c[1], z = c[2], mx = m * x, my = m * y, mz = m * z;
  const double xx = mz * z + my * y, yy = mz * z + mx * x, zz = my * y + mx * x;
  const double columns[] = {J(0, 0) + xx,
                            J(1, 0) - mx * y,
                            J(2, 0) - mx * z,
                            0,
                            -mz,
                            my,  //
                            J(0, 1) - my * x,
                            J(1, 1) + yy,
                            J(2, 1) - my * z,
                            mz,
                            0,
                            -mx,  //
                            J(0, 2) - mz * x,
                            J(1, 2) - mz * y,
                            J(2, 2) + zz,
                            -my,
                            mx,
                            0,  //
                            0,
                            mz,
                            -my,
                            m,
                            0,
                            0,  //
                            -mz,
                            0,
                            mx,
                            0,
                            m,
                            0,  //
                            my,
                            -mx,
                            0,
                            0,
                            0,
                            m};
  return Eigen::Map<const Matrix6d>(columns);
}

// Matrix of the linear map X -> I (X x V) + X x* (I V) + V x* (I X): the derivative with respect to V of V x*
// I V and of the velocity product that the outboard bodies inherit. V x* is minus the transpose of V x, so
// that the first and the last term are -(I V x) and its transpose; each row of I V x is two cross products.
inline Matrix6d velocity_gradient(const Matrix6d& I, const Vector6d& V) {
  const Vector6d h = I * V;
  Matrix6d turned;  // the transpose of I V x
  for (int j = 0; j < 6; ++j) {
    const double a = I(0, j), b = I(1, j), c = I(2, j), d = I(3, j), e = I(4, j), f = I(5, j);
    turned(0, j) = b * V[2] - c * V[1] + e * V[5] - f * V[4];
    turned(1, j) = c * V[0] - a * V[2] + f * V[3] - d * V[5];
    turned(2, j) = a * V[1] - b * V[0] + d * V[4] - e * V[3];
    turned(3, j) = e * V[2] - f * V[1];
    turned(4, j) = f * V[0] - d * V[2];
    turned(5, j) = d * V[1] - e * V[0];
  }
  Matrix6d G = -turned - turned.transpose();
  const Matrix3d top = skew(h.head<3>()), bottom = skew(h.tail<3>());  // X -> X x* h
  G.topLeftCorner<3, 3>() -= top;
  G.topRightCorner<3, 3>() -= bottom;
  G.bottomLeftCorner<3, 3>() -= bottom;
  return G;
}

}  // namespace tandem::mbd
