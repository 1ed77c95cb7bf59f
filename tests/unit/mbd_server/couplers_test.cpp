// Gear, belt, rack and pinion, and a screw that closes a loop, in motion against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "mbd_server/io/observation.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using scene::JointType;

constexpr double J1 = .03, J2 = .11, slider_mass = 4, T = 1.7;

// Wheel 1 at the origin, wheel 2 or a rack next to it, and a torque on wheel 1.
scene::Scene pair(scene::CouplerType type, double ratio, const scene::Motion& torque) {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId first = machines::add_body(scene, "first", 1, {J1, J1, J1}, {0, 0, 0});
  const BodyId second = machines::add_body(scene, "second", slider_mass, {J2, J2, J2}, {1, 0, 0});
  const bool rack = type == scene::CouplerType::rack_and_pinion;
  machines::add_joint(scene, "a", JointType::revolute, ground, first, {0, 0, 0});
  machines::add_joint(scene, "b", rack ? JointType::prismatic : JointType::revolute, ground, second,
                      {1, 0, 0}, rack ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1});
  scene.mbd->couplers.push_back({"coupler", type, JointId{0}, JointId{1}, ratio});
  scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, torque});
  return scene;
}

// q1 = T t^2 / 2 (J1 + r^2 I2), where I2 is the inertia at joint 2; the coupler transmits r I2 q1''.
void expect_driven(const char* what, scene::CouplerType type, double ratio, double inertia) {
  machines::Run run(pair(type, ratio, scene::ConstantMotion{T, 0}), 1e-3);
  double slip = 0;
  for (int i = 0; i < 2000; ++i) {
    run.advance(1);
    slip = std::max(
        slip, std::abs(run.state.q[1] - ratio * run.state.q[0]) / std::max(1., std::abs(run.state.q[1])));
  }
  const double a = T / (J1 + ratio * ratio * inertia), q = a * 2;
  run.system.residual(run.state);
  JointObserver observer(run.model);
  const auto& joints = observer.observe(run.state, run.system.links());
  const bool rack = type == scene::CouplerType::rack_and_pinion;
  const double passed = rack ? joints[1].reaction.force.x : joints[1].reaction.torque.z;
  const double kept = joints[0].reaction.torque.z;
  std::printf("%-16s ratio %5.2f: turned by %.9f rad, exact %.9f; slip %.1e; passes %.12f, exact %.12f\n",
              what, ratio, run.state.q[0], q, slip, passed, ratio * inertia * a);
  EXPECT_NEAR(run.state.q[0], q, 1e-9 * q);
  EXPECT_LT(slip, 1e-14);
  EXPECT_NEAR(passed, ratio * inertia * a, 1e-9);
  EXPECT_NEAR(kept, J1 * a, 1e-9);
  EXPECT_NEAR(std::abs(run.state.lambda[0]), std::abs(inertia * ratio * a), 1e-9);
}

TEST(Couplers, GearKeepsItsRatioAndPassesTheTorque) {
  expect_driven("gear", scene::CouplerType::gear, -2.5, J2);
}
TEST(Couplers, BeltKeepsItsRatioAndPassesTheTorque) {
  expect_driven("belt", scene::CouplerType::belt, .4, J2);
}
TEST(Couplers, RackMovesWithItsPinion) {
  expect_driven("rack and pinion", scene::CouplerType::rack_and_pinion, .08, slider_mass);
}

// A swinging torque: q1 = T / (J w) (t - sin(w t) / w).
TEST(Couplers, KeepTheRatioUnderATorqueThatChangesItsSign) {
  const double w = 20, ratio = -3, J = J1 + ratio * ratio * J2;
  const double f = w / (2 * std::acos(-1.));
  machines::Run run(pair(scene::CouplerType::gear, ratio, scene::HarmonicMotion{0, T, f, 0}), 2e-4);
  double slip = 0, worst = 0;
  for (int i = 0; i < 5000; ++i) {
    run.advance(1);
    slip = std::max(slip, std::abs(run.state.q[1] - ratio * run.state.q[0]));
    const double t = run.state.time, exact = T / (J * w) * (t - std::sin(w * t) / w);
    worst = std::max(worst, std::abs(run.state.q[0] - exact));
  }
  std::printf("gear under a swinging torque: slip %.1e rad, error %.1e rad of %.3f\n", slip, worst,
              run.state.q[0]);
  EXPECT_LT(slip, 1e-14);
  EXPECT_LT(worst, 1e-5 * run.state.q[0]);
}

// Planet gear: sun and planet turn on an arm and are geared relative to it, with the sun held by the ground.
// The planet turns at (1 + z) times the arm's rate; the arm has J_a + m r^2 + J_p (1 + z)^2.
TEST(Couplers, PlanetGearOnATurningArm) {
  const double z = 2.5, r = .3, Ja = .05, Jp = .01, mp = .8;
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId arm = machines::add_body(scene, "arm", 1, {Ja, Ja, Ja}, {0, 0, 0});
  const BodyId sun = machines::add_body(scene, "sun", 1, {.02, .02, .02}, {0, 0, 0});
  const BodyId planet = machines::add_body(scene, "planet", mp, {Jp, Jp, Jp}, {r, 0, 0});
  machines::add_joint(scene, "main", JointType::revolute, ground, arm, {0, 0, 0});
  machines::add_joint(scene, "center", JointType::revolute, arm, sun, {0, 0, 0});
  machines::add_joint(scene, "pin", JointType::revolute, arm, planet, {r, 0, 0});
  scene::Joint& hold = machines::add_joint(scene, "hold", JointType::fixed, ground, sun, {0, 0, 0});
  hold.cut = true;
  scene.mbd->couplers.push_back({"mesh", scene::CouplerType::gear, JointId{1}, JointId{2}, -z});
  scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, scene::ConstantMotion{T, 0}});
  machines::Run run(scene, 1e-3);
  run.advance(1000);
  const double a = T / (Ja + mp * r * r + Jp * (1 + z) * (1 + z));
  run.system.residual(run.state);
  const Twist twist = observe_body(run.model, run.system.links(), 2).twist;
  std::printf("planet gear: arm at %.9f rad/s, exact %.9f; planet at %.9f, exact %.9f\n", run.state.u[0], a,
              twist.w_WB.z, (1 + z) * a);
  EXPECT_NEAR(run.state.u[0], a, 1e-9 * a);
  EXPECT_NEAR(twist.w_WB.z, (1 + z) * a, 1e-9 * a);
}

// A spindle and a nut that slides on the ground, closed by a screw of pitch p: T = (J + m p^2) q''. The nut
// does not rotate, so that the spindle rotates relative to it. Many turns in both directions.
TEST(CutScrew, MovesTheNutOverManyTurns) {
  const double p = .004, a = T / (J1 + slider_mass * p * p);
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId spindle = machines::add_body(scene, "spindle", 1, {J1, J1, J1}, {0, 0, 0});
  const BodyId nut = machines::add_body(scene, "nut", slider_mass, {J2, J2, J2}, {0, .1, .5});
  machines::add_joint(scene, "turn", JointType::revolute, ground, spindle, {0, 0, 0});
  machines::add_joint(scene, "guide", JointType::prismatic, ground, nut, {0, .1, .5});
  scene::Joint& thread = machines::add_joint(scene, "thread", JointType::screw, spindle, nut, {0, 0, .5});
  thread.pitch = p;
  thread.cut = true;
  scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, scene::ConstantMotion{T, 0}});
  machines::Run run(scene, 1e-3);
  ASSERT_EQ(run.assembly.redundant.size(), 4u);
  double slip = 0;
  for (int i = 0; i < 2000; ++i) {
    run.advance(1);
    slip = std::max(slip, std::abs(run.state.q[1] + p * run.state.q[0]));
  }
  const double q = a * 2;
  std::printf("cut screw: %.3f turns, exact %.3f; nut at %.9f m, exact %.9f; slip %.1e m\n",
              run.state.q[0] / 6.2831853, q / 6.2831853, run.state.q[1], -p * q, slip);
  EXPECT_GT(q, 2 * 6.2831853);
  EXPECT_NEAR(run.state.q[0], q, 1e-9 * q);
  EXPECT_NEAR(run.state.q[1], -p * q, 1e-9 * p * q);
  EXPECT_LT(slip, 1e-13);
}

}  // namespace
}  // namespace tandem::mbd
