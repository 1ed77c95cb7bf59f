// Stiffness of the contacts of a body with the ground, against the sum over its points.
#include "mbd_server/coupling/contact_tangents.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

constexpr double point_stiffness = 1e6, box_mass = 1, acceleration_of_gravity = 9.81;
const Vector3d half_box(0.1, 0.05, 0.03);
using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

// A box that particles touch stands on a plane, both turned by R.
scene::Scene box_on_plane(const Quaterniond& R) {
  scene::Scene scene = machines::empty(to_vec3(R * Vector3d(0, 0, -acceleration_of_gravity)));
  const double depth = box_mass * acceleration_of_gravity / (4 * point_stiffness);
  const BodyId box = machines::add_body(scene, "box", box_mass, {1e-3, 1e-3, 1e-3},
                                        to_vec3(R * Vector3d(0, 0, half_box.z() - depth)));
  scene.mbd->bodies[0].pose.q_WB = {R.w(), R.x(), R.y(), R.z()};
  scene.contact.emplace();
  scene.contact->materials.push_back({"stuff", point_stiffness, 0, 0, 0.5, 0.5});
  scene::Shape shape;
  shape.use = scene::ShapeUse::contact;
  shape.contact_material = 0;
  shape.name = "floor";
  shape.geometry = scene::PlaneShape{{0, 0, 0}, to_vec3(R * Vector3d::UnitZ())};
  scene.contact->ground.push_back(shape);
  shape.name = "hull";
  shape.body = box;
  shape.is_of_body = true;
  shape.geometry = scene::BoxShape{{2 * half_box.x(), 2 * half_box.y(), 2 * half_box.z()}, {}};
  scene.shapes.push_back(shape);
  scene.dem.emplace().walls.emplace_back().body = box;
  return scene;
}

TEST(ContactTangents, OfABoxAreTheSumOverItsCorners) {
  RowMajor6 of_box = RowMajor6::Zero();
  const Vector3d of_point(2.0 / 7 * point_stiffness, 2.0 / 7 * point_stiffness, point_stiffness);
  for (const double x : {-half_box.x(), half_box.x()})
    for (const double y : {-half_box.y(), half_box.y()}) {
      Eigen::Matrix<double, 3, 6> J;
      J << Matrix3d::Identity(), -skew({x, y, -half_box.z()});
      of_box += J.transpose() * of_point.asDiagonal() * J;
    }
  for (const Quaterniond& R : {Quaterniond::Identity(), Quaterniond(0.3, -0.5, 0.7, 0.2).normalized()}) {
    MbdSolver solver;
    solver.configure(box_on_plane(R));
    const protocol::TangentSet& set = solver.linearise();
    ASSERT_EQ(set.bodies.size(), 1u);
    EXPECT_EQ(set.time.count, 0);
    EXPECT_EQ(set.bodies[0].body, 0u);
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R.toRotationMatrix();
    const RowMajor6 expected = turn * of_box * turn.transpose(),
                    measured = Eigen::Map<const RowMajor6>(set.bodies[0].stiffness.data()),
                    damping = Eigen::Map<const RowMajor6>(set.bodies[0].damping.data());
    const double error = (measured - expected).norm() / expected.norm();
    std::printf("  stiffness of four corners: relative error %.1e  tolerance 1e-5 (turning of the load)\n",
                error);
    EXPECT_LT(error, 1e-5);
    const Vector3d n = R * Vector3d::UnitZ();
    EXPECT_GT(n.dot(damping.topLeftCorner<3, 3>() * n), 0);
  }
}

TEST(ContactTangents, AreOfBodiesThatTouchOnly) {
  scene::Scene scene = box_on_plane(Quaterniond::Identity());
  scene.mbd->bodies[0].pose.p_WB.z += 0.01;
  MbdSolver solver;
  solver.configure(scene);
  EXPECT_TRUE(solver.linearise().bodies.empty());
}

}  // namespace
}  // namespace tandem::mbd
