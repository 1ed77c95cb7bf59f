#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"
#include "mbd_server/joints/elementary_joint.hpp"

namespace tandem::mbd {
namespace {

TEST(ElementaryJoint, SubspaceIsTheVelocityOfThePose) {
  // The relative velocity of the pose between q and q o exp(e x), by differences, is S x.
  const Vector3d axis = Vector3d(1, 2, -1).normalized();
  const double q0[4] = {.5, .5, -.5, .5}, x[3] = {.3, -.7, .4}, e = 1e-6;
  for (const Elementary kind : {Elementary::revolute, Elementary::prismatic, Elementary::screw,
                                Elementary::translation, Elementary::spherical}) {
    double plus[4], minus[4], step[3] = {e * x[0], e * x[1], e * x[2]},
                              back[3] = {-step[0], -step[1], -step[2]};
    move(kind, q0, step, plus);
    move(kind, q0, back, minus);
    const JointPose a = joint_pose(kind, axis, .3, minus), b = joint_pose(kind, axis, .3, plus),
                    at = joint_pose(kind, axis, .3, q0);
    const Matrix3d R = at.rotation.toRotationMatrix();
    const Matrix3d W =
        (b.rotation.toRotationMatrix() - a.rotation.toRotationMatrix()) / (2 * e) * R.transpose();
    const Vector3d w(W(2, 1), W(0, 2), W(1, 0)), v = (b.displacement - a.displacement) / (2 * e);
    Eigen::Matrix<double, 6, 3> S;
    const int n = motion_subspace(kind, axis, .3, R, at.displacement, S);
    Vector6d V = Vector6d::Zero();
    for (int k = 0; k < n; ++k) V += S.col(k) * x[k];
    EXPECT_EQ(n, freedoms(kind));
    EXPECT_LT((V.head<3>() - w).norm(), 1e-9);
    EXPECT_LT((at_point(V, at.displacement) - v).norm(), 1e-9);
  }
}

TEST(ElementaryJoint, TangentOperatorIsTheDerivativeOfExp) {
  for (const double size : {1e-9, 1e-3, 9e-3, 1.1e-2, 1.0, 3.0}) {
    const Vector3d x = size * Vector3d(.6, -.48, .64);
    const Matrix3d T = tangent_operator(x);
    for (int k = 0; k < 3; ++k) {
      const double e = 1e-5;
      const Vector3d d = e * Vector3d::Unit(k);
      const Quat up = exp(to_vec3(x)).conjugate() * exp(to_vec3(x + d));
      const Quat down = exp(to_vec3(x)).conjugate() * exp(to_vec3(x - d));
      const Vector3d column = to_eigen(rotation_vector(up) - rotation_vector(down)) / (2 * e);
      EXPECT_LT((T.col(k) - column).norm(), 1e-9) << "|x| = " << size;
    }
  }
}

TEST(ElementaryJoint, SphericalStaysAUnitQuaternion) {
  double q[4] = {1, 0, 0, 0};
  const double x[3] = {.01, -.02, .015};
  for (int i = 0; i < 100000; ++i) move(Elementary::spherical, q, x, q);
  EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-15);
}

}  // namespace
}  // namespace tandem::mbd
