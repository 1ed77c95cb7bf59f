// The joints of the spanning tree.
//
// An elementary joint is a subgroup of the rigid motions whose motion subspace is constant in the frame of
// its outboard link; its coordinate rates u are the components of the relative velocity in that subspace.
// Every joint of a scene is a chain of elementary joints (free = translation, then spherical; the link
// between has no mass), so that kinematics, derivatives and updates need no special case. Seen from its other
// end, a chain is the reversed chain about negated axes.
#pragma once

#include <Eigen/Core>

#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

enum class Elementary {
  revolute,     // q: angle [rad]                                     u: its rate
  prismatic,    // q: displacement along the axis [m]                 u: its rate
  screw,        // q: angle, with a travel of pitch q [rad]           u: its rate
  translation,  // q: displacement in inboard axes [m] (3)            u: its rate (3)
  spherical,    // q: unit quaternion outboard to inboard w x y z (4) u: angular velocity in outboard axes
                // [rad/s] (3)
};

constexpr int coordinates(Elementary kind) {
  return kind == Elementary::spherical ? 4 : (kind == Elementary::translation ? 3 : 1);
}
constexpr int freedoms(Elementary kind) {
  return kind == Elementary::spherical || kind == Elementary::translation ? 3 : 1;
}
constexpr bool rotates(Elementary kind) {
  return kind == Elementary::revolute || kind == Elementary::screw || kind == Elementary::spherical;
}

// Pose of the outboard link in the inboard link, relative to their pose at zero coordinates.
struct JointPose {
  Quaterniond rotation = Quaterniond::Identity();
  Vector3d displacement = Vector3d::Zero();  // inboard axes [m]
};
// `pitch` [m/rad] is used for a screw only.
JointPose joint_pose(Elementary kind, const Vector3d& axis, double pitch, const double* q);

// Writes the columns of the motion subspace in world axes about the world's origin into S; R and p are the
// pose of the outboard link. Returns the number of columns.
int motion_subspace(Elementary kind, const Vector3d& axis, double pitch, const Matrix3d& R, const Vector3d& p,
                    Eigen::Matrix<double, 6, 3>& S);

// q1 = q0 o exp(x)
void move(Elementary kind, const double* q0, const double* x, double* q1);
// The x with q1 = q0 o exp(x); for a spherical joint, |x| <= pi.
void difference(Elementary kind, const double* q0, const double* q1, double* x);

// exp(x + dx) = exp(x) exp(T(x) dx): the 3x3 tangent operator of a spherical joint, identity for all others.
Matrix3d tangent_operator(const Vector3d& x);
// Its inverse: in q = q0 o exp(x) the rate of x is that operator times u. For |x| < 2 pi.
Matrix3d inverse_tangent_operator(const Vector3d& x);

}  // namespace tandem::mbd
