// Motors and cylinders: their states in the integrator, on disk, under error control and with extrapolation;
// limits of what they are asked for.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "common/error.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "mbd_server/forces/drive.hpp"
#include "mbd_server/io/state_file.hpp"
#include "mbd_server/solve/equilibrium.hpp"
#include "mbd_server/solve/modes.hpp"
#include "mbd_server/step/richardson.hpp"
#include "mbd_server/step/step_control.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

constexpr double inertia = .4;

// A wheel whose motor controls the speed, with a brake and an integral.
scene::Scene controlled_wheel(const scene::Motor& motor) {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId body = machines::add_body(scene, "wheel", 1, {inertia, inertia, inertia}, {0, 0, 0});
  machines::add_joint(scene, "axle", scene::JointType::revolute, ground, body, {0, 0, 0});
  scene.mbd->forces.push_back(motor);
  return scene;
}

scene::Motor speed_motor() {
  scene::Motor motor;
  motor.name = "motor", motor.joint = JointId{0};
  motor.target = scene::ConstantMotion{5, 0};
  motor.gains = {2, 6, 0, 0, {}};
  return motor;
}

TEST(Drives, SavedStatesContinueToTheSameBits) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("tandem_drives_" + std::to_string(getpid()) + ".h5");
  machines::Run straight(controlled_wheel(speed_motor()), 1e-2, .8);
  ASSERT_EQ(straight.state.z.size(), 1);
  straight.advance(20);
  write_state(path, straight.model, straight.state);
  straight.advance(20);
  machines::Run resumed(controlled_wheel(speed_motor()), 1e-2, .8);
  resumed.state = read_state(path, resumed.model).state;
  resumed.advance(20);
  std::filesystem::remove(path);
  EXPECT_EQ(hash(resumed.state), hash(straight.state));
  State other = straight.state;
  other.z[0] = std::nextafter(other.z[0], 1e9);
  EXPECT_NE(hash(other), hash(straight.state));
}

// A state without states of first order has the hash that it had before there were any.
TEST(Drives, MachinesWithoutStatesHaveNone) {
  machines::Run run(machines::menagerie(), 1e-3);
  EXPECT_EQ(run.state.z.size(), 0);
  EXPECT_EQ(packed_size(run.state), run.state.q.size() + 4 * run.state.u.size() + run.state.lambda.size());
}

TEST(Drives, UndoneStepsLeaveNoTrace) {
  machines::Run run(controlled_wheel(speed_motor()), 1e-2, .8);
  run.advance(3);
  const std::string before = hash(run.state);
  ASSERT_TRUE(run.integrator.try_step(run.system, run.state, .3));
  EXPECT_NE(hash(run.state), before);
  run.integrator.undo(run.state);
  EXPECT_EQ(hash(run.state), before);
}

// The states alone limit the steps: a wheel that a motor holds at its target while the target's filter moves.
TEST(Drives, ErrorControlWatchesTheStates) {
  scene::Motor motor = speed_motor();
  motor.gains = {0, 1e-9, 0, 0, 1.0};
  motor.target = scene::HarmonicMotion{0, 1, 2, 0};
  machines::Run run(controlled_wheel(motor), 1e-2, .8);
  const auto error = run.integrator.try_step(run.system, run.state, 5e-2);
  ASSERT_TRUE(error);
  EXPECT_LT(error->position, 1e-9);
  EXPECT_GT(error->states, 1e-6);
  EXPECT_EQ(run.integrator.largest_state_error(run.system), "integral of motor \"motor\"");
}

TEST(Drives, ExtrapolationCarriesTheStates) {
  const double t = .5, kp = 2, ki = 6, target = 5;
  // I u'' + kp u' + ki u = ki target, from rest.
  const double a = kp / (2 * inertia), b = std::sqrt(ki / inertia - a * a);
  const double u0 = -target, v0 = kp * target / inertia;
  const double exact =
      target + std::exp(-a * t) * (u0 * std::cos(b * t) + (v0 + a * u0) / b * std::sin(b * t));
  double last = 0;
  for (const int n : {20, 40, 80}) {
    machines::Run run(controlled_wheel(speed_motor()), t / n, .8);
    Richardson twice(run.integrator, run.state);
    twice.start(run.system, run.state, t / n);
    for (int i = 0; i < n; ++i) twice.step(run.system, run.state, t / n);
    const double error = std::abs(run.state.u[0] - exact);
    std::printf("extrapolated PI control, %d steps: error %.2e\n", n, error);
    if (last > 0) {
      EXPECT_GT(std::log2(last / error), 2.7);
    }
    last = error;
  }
}

// The closed form with a limit against the same equation by bisection.
TEST(Drives, LimitedIntegralSolvesItsEquation) {
  Drive drive;
  drive.of = Drive::Of::rate;
  drive.proportional = 3, drive.integral = 7, drive.derivative = .4, drive.filter = .05;
  drive.anti_windup = .3, drive.limit = 5;
  for (const double v : {-4., -1., 0., .7, 1., 1.4, 9.})
    for (const double weight : {0., 1e-3, .1, 10.})
      for (const double known : {-2., 0., .9}) {
        const StatesOfElement z0(known, .2);
        const ElementValue out = evaluate(drive, {1, 0}, 0, v, z0, weight);
        EXPECT_NEAR(out.z[0], z0[0] + weight * out.zdot[0], 1e-12 * (1 + weight));
        EXPECT_NEAR(out.z[1], z0[1] + weight * out.zdot[1], 1e-12 * (1 + weight));
        const double error = 1 - v;
        const double asked = 3 * error + 7 * out.z[0] + .4 * (error - out.z[1]) / .05;
        EXPECT_NEAR(out.zdot[1], (error - out.z[1]) / .05, 1e-9);
        EXPECT_NEAR(out.force, std::clamp(asked, -5., 5.), 1e-9 * (1 + std::abs(asked)));
        EXPECT_NEAR(out.zdot[0], error + (out.force - asked) / (7 * .3), 1e-9 * (1 + std::abs(asked)));
      }
}

TEST(Drives, AControllerMustKeepToTheRange) {
  scene::Motor motor = speed_motor();
  motor.control = scene::MotorControl::throttle, motor.gains = {};
  motor.torque_speed = scene::ForceTable{{0, 100}, {10, 0}};
  motor.input = "pedal";
  scene::Scene scene = controlled_wheel(motor);
  MbdSolver solver;
  solver.configure(scene);
  solver.control({{0}, {.5}});
  try {
    solver.control({{0}, {1.5}});
    FAIL() << "1.5 was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.problem(), "the controller asks for 1.5 at the throttle of motor \"motor\"");
    EXPECT_EQ(error.hint(), "send a value from -1 to 1");
  }
}

}  // namespace
}  // namespace tandem::mbd
