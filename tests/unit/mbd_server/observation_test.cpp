// Reactions and energy.
#include <gtest/gtest.h>

#include <cmath>

#include "mbd_server/io/observation.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using scene::JointType;
constexpr double g = 9.81;

TEST(Reactions, HoldTheWeightThroughWeldsAndDrives) {
  scene::Scene scene = machines::empty();
  const BodyId base = machines::add_body(scene, "base", 3, {1, 1, 1}, {0, 0, 0});
  const BodyId arm = machines::add_body(scene, "arm", 2, {1, 1, 1}, {1, 0, 0});
  const BodyId tip = machines::add_body(scene, "tip", 1, {1, 1, 1}, {2, 0, 0});
  machines::add_joint(scene, "bolt", JointType::fixed, ground, base, {0, 0, 0});
  machines::add_joint(scene, "drive", JointType::revolute, base, arm, {.5, 0, 0}, {0, 1, 0}).motion =
      scene::ConstantMotion{};
  machines::add_joint(scene, "glue", JointType::fixed, arm, tip, {1.5, 0, 0});
  machines::add_wall(scene, tip);
  machines::Run run(scene, 1e-3);
  run.state.loads.col(0) = spatial(Vector3d(0, 0, .7), Vector3d(0, 5, 0));
  run.system.residual(run.state);
  JointObserver observer(run.model);
  const auto& joints = observer.observe(run.state, run.system.links());
  // Force upwards, less the load of 5 N in y; moments about the joint points.
  const auto expect = [](const Wrench& w, Vec3d force, Vec3d torque) {
    EXPECT_LT(norm(w.force - force), 1e-12);
    EXPECT_LT(norm(w.torque - torque), 1e-12);
  };
  expect(joints[2].reaction, {0, -5, 1 * g}, {0, -.5 * g, -.7 - .5 * 5});
  expect(joints[1].reaction, {0, -5, 3 * g}, {0, -(.5 * 2 + 1.5) * g, -.7 - 1.5 * 5});
  expect(joints[0].reaction, {0, -5, 6 * g}, {0, -(1 * 2 + 2) * g, -.7 - 2 * 5});
}

TEST(Reactions, HaveNoPartAlongAFreeAxis) {
  machines::Run run(machines::menagerie(), 1e-3);
  run.advance(200);
  run.system.residual(run.state);
  JointObserver observer(run.model);
  const auto& joints = observer.observe(run.state, run.system.links());
  const auto axis = [&](int j) {
    const LinkIndex l = run.model.joints[j].link;
    return to_vec3(run.system.links()[l].R_WL * run.model.links[l].axis);
  };
  EXPECT_NEAR(dot(joints[0].reaction.force, axis(0)), 0, 1e-9);   // rail
  EXPECT_NEAR(dot(joints[3].reaction.torque, axis(3)), 0, 1e-9);  // twist
  EXPECT_NEAR(dot(joints[5].reaction.torque, axis(5)), 0, 1e-9);  // spindle
  // Spherical, with damping .05 N m s: the torque of the joint is that of the damping.
  const Vector3d rate = run.state.u.segment<3>(run.model.links[run.model.joints[2].link].u);
  EXPECT_NEAR(norm(joints[2].reaction.torque), .05 * rate.norm(), 1e-9);
}

TEST(Reactions, PendulumPullsWithItsCentrifugalForce) {
  machines::Run run(machines::pendulum(), 1e-4);
  run.advance(4000);
  run.system.residual(run.state);
  JointObserver observer(run.model);
  const Wrench reaction = observer.observe(run.state, run.system.links())[0].reaction;
  // From rest at the horizontal: tension 3 m g cos(phi) = -3 m g y.
  const Vector3d p = run.position(0);
  EXPECT_NEAR(-dot(reaction.force, to_vec3(p)), 3 * g * -p.y(), 1e-5);
  EXPECT_LT(norm(reaction.torque), 1e-12);
}

TEST(Energy, CountsMotionWeightAndSprings) {
  scene::Scene scene = machines::free_body(2, {1, 2, 3}, {0, 0, -g});
  scene.mbd->bodies[0].pose.p_WB = {0, 0, 5};
  scene.mbd->bodies[0].twist = {{1, 2, 2}, {0, 0, 4}};
  scene.mbd->forces.push_back(scene::SpringDamper{"s", ground, BodyId{0}, {0, 0, 0}, {0, 0, 5}, 10, 0, 2});
  machines::Run run(scene, 1e-3);
  run.system.residual(run.state);
  EXPECT_NEAR(energy(run.model, run.state, run.system.links()),
              .5 * 2 * 9 + .5 * 3 * 16 + 2 * g * 5 + .5 * 10 * 9, 1e-12);
}

}  // namespace
}  // namespace tandem::mbd
