#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"
#include "mbd_server/joints/elementary_joint.hpp"
#include "mbd_server/joints/motion_function.hpp"

namespace tandem::mbd {
namespace {

TEST(ElementaryJoint, SubspaceIsTheVelocityOfThePose) {
  // The relative velocity of the pose between q and q o exp(e x), by differences, is S x.
  const Vector3d axis = Vector3d(1, 2, -1).normalized();
  const double q0[4] = {.5, .5, -.5, .5}, x[3] = {.3, -.7, .4}, e = 1e-6;
  for (const Elementary kind :
       {Elementary::revolute, Elementary::prismatic, Elementary::screw, Elementary::translation, Elementary::spherical}) {
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

void expect_derivatives(const scene::Motion& motion, const std::vector<double>& times) {
  const MotionFunction f(motion);
  const double e = 1e-5;
  for (const double t : times) {
    const CoordinateMotion a = f.at(t - e), b = f.at(t), c = f.at(t + e);
    EXPECT_NEAR(b.rate, (c.value - a.value) / (2 * e), 1e-7) << "at " << t;
    EXPECT_NEAR(b.acceleration, (c.rate - a.rate) / (2 * e), 1e-6) << "at " << t;
  }
}

TEST(Motion, DerivativesBelongToTheValues) {
  const std::vector<double> times{.013, .21, .47, .74, .93};
  expect_derivatives(scene::ConstantMotion{1, 2}, times);
  expect_derivatives(scene::RampMotion{.5, 2, .1, .8}, times);
  expect_derivatives(scene::HarmonicMotion{.2, .7, 1.3, .4}, times);
  expect_derivatives(scene::TableMotion{{0, .2, .5, .6, 1}, {0, 1, -1, .5, .3}}, times);
}

TEST(Motion, RampIsAtRestOutside) {
  const MotionFunction f(scene::RampMotion{1, 3, .5, 2});
  EXPECT_EQ(f.at(.5).value, 1);
  EXPECT_EQ(f.at(2.5).value, 3);
  EXPECT_NEAR(f.at(1.5).value, 2, 1e-15);
  for (const double t : {0.0, .5, 2.5, 9.0}) {
    EXPECT_EQ(f.at(t).rate, 0);
    EXPECT_EQ(f.at(t).acceleration, 0);
  }
}

TEST(Motion, TablePassesThroughItsPointsAndIsSmooth) {
  const scene::TableMotion table{{0, .2, .5, .6, 1}, {0, 1, -1, .5, .3}};
  const MotionFunction f(table);
  for (std::size_t i = 0; i < table.times.size(); ++i)
    EXPECT_NEAR(f.at(table.times[i]).value, table.values[i], 1e-14);
  for (std::size_t i = 1; i + 1 < table.times.size(); ++i) {
    const CoordinateMotion before = f.at(table.times[i] - 1e-9), after = f.at(table.times[i] + 1e-9);
    EXPECT_NEAR(before.rate, after.rate, 1e-5);
    EXPECT_NEAR(before.acceleration, after.acceleration, 1e-5);
  }
  EXPECT_EQ(f.at(-1).value, 0);
  EXPECT_EQ(f.at(2).value, .3);
  EXPECT_EQ(f.at(2).rate, 0);
}

TEST(Motion, LinearTableIsALine) {
  const MotionFunction f(scene::TableMotion{{0, 1, 3}, {0, 2, 6}});
  EXPECT_NEAR(f.at(1.7).value, 3.4, 1e-14);
  EXPECT_NEAR(f.at(1.7).rate, 2, 1e-14);
  EXPECT_NEAR(f.at(1.7).acceleration, 0, 1e-13);
}

TEST(Motion, RefusesATableOfOnePoint) {
  EXPECT_THROW(MotionFunction(scene::TableMotion{{0}, {1}}), Error);
}

}  // namespace
}  // namespace tandem::mbd
