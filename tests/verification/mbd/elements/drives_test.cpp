// Motors and controlled cylinders against closed forms.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>

#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace drives_test {

constexpr double inertia = .4;

scene::Scene wheel(const scene::Motor& motor, double load = 0) {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId body = machines::add_body(scene, "wheel", 1, {inertia, inertia, inertia}, {0, 0, 0});
  machines::add_joint(scene, "axle", scene::JointType::revolute, ground, body, {0, 0, 0});
  scene.mbd->forces.push_back(motor);
  if (load != 0)
    scene.mbd->forces.push_back(scene::Actuator{"load", JointId{0}, scene::ConstantMotion{load, 0}});
  return scene;
}

scene::Motor motor(scene::MotorControl control, double target, const scene::Gains& gains) {
  scene::Motor m;
  m.name = "motor", m.joint = JointId{0}, m.control = control;
  m.target = scene::ConstantMotion{target, 0};
  m.gains = gains;
  return m;
}

// I u'' + kp u' + ki u = ki target from rest under a load: u over time, and its integral of the error.
struct PiSpeed {
  double kp = 2, ki = 6, target = 5, load = -1.5;
  double a = kp / (2 * inertia), b = std::sqrt(ki / inertia - a * a);
  double u(double t) const {
    const double u0 = -target, v0 = (kp * target + load) / inertia;
    return target + std::exp(-a * t) * (u0 * std::cos(b * t) + (v0 + a * u0) / b * std::sin(b * t));
  }
  double integral(double t) const {  // from I u' = kp (target - u) + ki z + load
    const double e = 1e-6, rate = (u(t + e) - u(t - e)) / (2 * e);
    return (inertia * rate - kp * (target - u(t)) - load) / ki;
  }
};

TEST(SpeedControl, FollowsTheContinuousSolutionWithOrderTwo) {
  const PiSpeed exact;
  const double t = .8;
  for (const double rho : {.5, .8, 1.}) {
    OrderTable table("PI speed control with a load at t = 0.8 s, rho_inf = " + std::to_string(rho),
                     {"rate [rad/s]", "integral [rad]"});
    for (int n = 80; n <= 640; n *= 2) {
      machines::Run run(
          wheel(motor(scene::MotorControl::speed, exact.target, {exact.kp, exact.ki, 0, 0, {}}), exact.load),
          t / n, rho);
      run.advance(n);
      table.add(t / n, {std::abs(run.state.u[0] - exact.u(t)), std::abs(run.state.z[0] - exact.integral(t))});
    }
    table.expect_order(2.0, 0.1);
  }
}

// The scheme applied to the linear equations is a matrix power: rate and integral to round-off.
TEST(SpeedControl, IsTheSchemesOwnClosedForm) {
  const PiSpeed p;
  const double h = .02;
  for (const double rho : {.3, .8}) {
    const GeneralizedAlphaConstants c(rho);
    machines::Run run(wheel(motor(scene::MotorControl::speed, p.target, {p.kp, p.ki, 0, 0, {}}), p.load), h,
                      rho);
    // x = [u, u', a, z, z', w]; A x1 = B x0 + f.
    using Matrix6 = Eigen::Matrix<double, 6, 6>;
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    Matrix6 A = Matrix6::Zero(), B = A;
    Vector6 f = Vector6::Zero(), x;
    const auto advance_by = [&](int row, int value, int algorithmic) {
      A(row, value) = B(row, value) = 1;
      A(row, algorithmic) = -h * c.gamma, B(row, algorithmic) = h * (1 - c.gamma);
    };
    const auto filter = [&](int row, int rate, int algorithmic) {
      A(row, algorithmic) = 1 - c.alpha_m, B(row, algorithmic) = -c.alpha_m;
      A(row, rate) = -(1 - c.alpha_f), B(row, rate) = c.alpha_f;
    };
    advance_by(0, 0, 2), filter(1, 1, 2), advance_by(2, 3, 5), filter(3, 4, 5);
    A(4, 1) = inertia, A(4, 0) = p.kp, A(4, 3) = -p.ki, f[4] = p.kp * p.target + p.load;
    A(5, 4) = 1, A(5, 0) = 1, f[5] = p.target;
    x << run.state.u[0], run.state.udot[0], run.state.a[0], run.state.z[0], run.state.zdot[0], run.state.w[0];
    double worst = 0;
    for (int i = 0; i < 100; ++i) {
      x = A.partialPivLu().solve(B * x + f);
      run.advance(1);
      worst = std::max({worst, std::abs(x[0] - run.state.u[0]), std::abs(x[3] - run.state.z[0])});
    }
    std::printf(
        "PI control, rho_inf = %.1f: largest difference to the scheme's closed form %.1e, tolerance "
        "1e-12\n",
        rho, worst);
    EXPECT_LT(worst, 1e-12);
  }
}

// The wheel speeds up at the limit, u = T t / I; without anti-windup its integral would have grown by half
// the target times that time. It arrives with an overshoot below 5 %.
TEST(SpeedControl, ALimitedTorqueDoesNotWindUp) {
  scene::Motor m = motor(scene::MotorControl::speed, 10, {4, 20, 0, 0, {}});
  m.max_torque = .5, m.gear_ratio = 2;
  machines::Run run(wheel(m), 1e-3, .8, {1e-10, 20});
  run.advance(3000);
  std::printf("at the limit: rate after 3 s %.9f, expected %.9f rad/s, tolerance 1e-9\n", run.state.u[0],
              1. / inertia * 3);
  EXPECT_NEAR(run.state.u[0], 3 / inertia, 1e-9);
  double highest = 0;
  for (int i = 0; i < 6000; ++i) run.advance(1), highest = std::max(highest, run.state.u[0]);
  std::printf("overshoot %.3f rad/s of 10, then %.9f; shortened steps %d\n", highest - 10, run.state.u[0],
              static_cast<int>(run.integrator.shortened().count));
  EXPECT_LT(highest, 10.5);
  EXPECT_NEAR(run.state.u[0], 10, 1e-3);
  EXPECT_EQ(run.integrator.shortened().count, 0u);
}

// I q'' = kp (r - q) + ki z - kd q' + load comes to r without an error, whatever the load.
TEST(PositionControl, HoldsItsTargetUnderLoad) {
  for (const double filter : {0., .01}) {
    machines::Run run(wheel(motor(scene::MotorControl::position, 1.2, {40, 60, 6, filter, {}}), -3), 1e-2,
                      .8);
    run.advance(3000);
    std::printf("PID position with a load, filter %.2f s: %.12f, expected 1.2 rad, tolerance 1e-9\n", filter,
                run.state.q[0]);
    EXPECT_NEAR(run.state.q[0], 1.2, 1e-9);
    EXPECT_NEAR(60 * run.state.z[0], 3, 1e-7);
  }
}

// Torque 12 N m at rest, 0 at 100 rad/s, in a gear of 4, at throttle x, under a load of M:
// x 4 (12 - 0.12 4 u) = M. The approach has the time constant (I + 16 J) / (16 x 0.12).
TEST(TorqueSpeed, SettlesWhereTheCurveMeetsTheLoad) {
  for (const double throttle : {1., .5, -.5}) {
    scene::Motor m = motor(scene::MotorControl::throttle, throttle, {});
    m.torque_speed = scene::ForceTable{{0, 50, 100}, {12, 6, 0}};
    m.gear_ratio = 4, m.rotor_inertia = .01;
    const double load = std::copysign(8, -throttle), x = std::abs(throttle);
    const double slope = 16 * x * .12, settled = std::copysign((48 * x - 8) / slope, throttle);
    const double tau = (inertia + 16 * .01) / slope;
    OrderTable table("torque-speed curve after one time constant, throttle " + std::to_string(throttle),
                     {"rate [rad/s]"});
    for (int n = 20; n <= 160; n *= 2) {
      machines::Run run(wheel(m, load), tau / n, .8);
      run.advance(n);
      table.add(tau / n, {std::abs(run.state.u[0] - settled * (1 - std::exp(-1)))});
    }
    table.expect_order(2.0, 0.1);
    machines::Run run(wheel(m, load), tau / 10, .8);
    run.advance(600);
    std::printf("equilibrium %.12f, expected %.12f rad/s, tolerance 1e-9\n", run.state.u[0], settled);
    EXPECT_NEAR(run.state.u[0], settled, 1e-9);
  }
}

// -torque tanh(u / slip): an engaged brake of 6 N m holds a load of 2 N m at slip atanh(1/3), and releases it
// at t = 1 s.
TEST(Brake, HoldsAndReleases) {
  scene::Motor m = motor(scene::MotorControl::throttle, 0, {});
  m.torque_speed = scene::ForceTable{{0, 1}, {1, 1}};
  m.brake = scene::Brake{6, 1e-3, {}, {}, ""};
  m.brake->engaged = scene::TableMotion{{0, 1, 2}, {1, 0, 0}, scene::Interpolation::step, 0, {}, 0};
  scene::Scene scene = wheel(m, 2);
  scene.end_time = 2, scene.coupling.window = 1e-2;
  scene.mbd->integrator.step = 1e-3;
  machines::WholeRun run(scene);
  const double creep = 1e-3 * std::atanh(1. / 3), rate = run.solver.state().u[0];
  const double expected = creep + 2 / inertia;
  std::printf("rate one second after the release %.9f, expected %.9f rad/s, tolerance 1e-6\n", rate,
              expected);
  EXPECT_NEAR(rate, expected, 1e-6);
  const auto facts = run.facts();
  std::printf("residual of the energy balance %.1e J\n", facts["mbd_energy_balance_J"].get<double>());
  EXPECT_NEAR(facts["mbd_energy_balance_J"].get<double>(), 0, 1e-6);
}

// A brake with stiction: 6 N m hold a load of 2 N m to the last bit while it is let off from t = 1 s to 2 s,
// until a third of it is left; then it slips with 5 N m times its share. It is engaged at t = 3 s, stops the
// wheel and holds it again.
TEST(Brake, HoldsToTheLastBit) {
  scene::Motor m = motor(scene::MotorControl::throttle, 0, {});
  m.torque_speed = scene::ForceTable{{0, 1}, {1, 1}};
  m.brake = scene::Brake{5, 0, 6, {}, ""};
  m.brake->engaged =
      scene::TableMotion{{0, 1, 2, 3, 3.0000001}, {1, 1, 0, 0, 1}, scene::Interpolation::linear, 0, {}, 0};
  const double slips = 5. / 3, rate_2 = (2 * (2 - slips) - 5 * std::pow(2 - slips, 2) / 2) / inertia,
               rate_3 = rate_2 + 2 / inertia, stops = 3 + rate_3 * inertia / 3;
  std::printf("%-34s %14s %14s %10s\n", "brake with stiction", "expected", "measured", "tolerance");
  const auto expect = [](const char* what, double measured, double expected, double tolerance) {
    std::printf("%-34s %14.9f %14.9f %10.0e\n", what, expected, measured, tolerance);
    EXPECT_NEAR(measured, expected, tolerance) << what;
  };
  const auto run_to = [&](double end) {
    scene::Scene scene = wheel(m, 2);
    scene.end_time = end, scene.coupling.window = 1e-2;
    scene.mbd->integrator.step = 1e-3;
    return std::make_unique<machines::WholeRun>(scene);
  };
  expect("angle at t = 1.66 s [rad]", run_to(1.66)->solver.state().q[0], 0, 0);
  expect("rate at t = 2 s [rad/s]", run_to(2)->solver.state().u[0], rate_2, 1e-5);
  expect("rate at t = 3 s [rad/s]", run_to(3)->solver.state().u[0], rate_3, 1e-5);
  const auto before = run_to(std::floor(100 * stops) / 100), after = run_to(5);
  expect("rate just before it stops [rad/s]", before->solver.state().u[0],
         (stops - std::floor(100 * stops) / 100) * 3 / inertia, 1e-5);
  expect("rate at t = 5 s [rad/s]", after->solver.state().u[0], 0, 0);
  expect("angle at 5 s less that at 4.5 s [rad]",
         after->solver.state().q[0] - run_to(4.5)->solver.state().q[0], 0, 0);
  expect("residual of the energy [J]", after->facts()["mbd_energy_balance_J"].get<double>(), 0, 1e-4);
}

scene::Scene lift(const scene::Cylinder& cylinder) {
  scene::Scene scene = machines::empty();
  const BodyId body = machines::add_body(scene, "mass", 3, {.1, .1, .1}, {0, 0, 1});
  machines::add_joint(scene, "rail", scene::JointType::prismatic, ground, body, {0, 0, 1});
  scene.mbd->forces.push_back(cylinder);
  return scene;
}

TEST(Cylinder, ForceLiftsAMass) {
  scene::Cylinder c;
  c.name = "jack", c.body_b = BodyId{0}, c.point_b = {0, 0, 1};
  c.target = scene::ConstantMotion{3 * 9.81 + 6, 0};
  machines::Run run(lift(c), 1e-2, .8);
  run.advance(100);
  std::printf("lifted %.12f, expected 1 m, tolerance 1e-12\n", run.state.q[0]);
  EXPECT_NEAR(run.state.q[0], 1, 1e-12);
}

// A PI controlled stroke brings the weight to its target; with max_force below the weight it cannot.
TEST(Cylinder, StrokeIsReachedWithinItsForce) {
  scene::Cylinder c;
  c.name = "jack", c.body_b = BodyId{0}, c.point_b = {0, 0, 1};
  c.control = scene::CylinderControl::stroke;
  c.target = scene::RampMotion{0, .3, .1, .5, {}, 0};
  c.gains = {4e3, 8e3, 400, 0, {}};
  c.max_force = 60;
  machines::Run run(lift(c), 5e-3, .8, {1e-10, 20});
  run.advance(4000);
  std::printf("stroke %.12f, expected 0.3 m, tolerance 1e-9; shortened steps %d\n", run.state.q[0],
              static_cast<int>(run.integrator.shortened().count));
  EXPECT_NEAR(run.state.q[0], .3, 1e-9);
  c.max_force = 20;
  machines::Run weak(lift(c), 5e-3, .8, {1e-10, 20});
  weak.advance(100);
  const double fallen = (20. / 3 - 9.81) / 2 * .25;
  std::printf("with 20 N: %.6f, expected about %.6f m, tolerance 5 %%\n", weak.state.q[0], fallen);
  EXPECT_NEAR(weak.state.q[0], fallen, 5e-2 * std::abs(fallen));
}

}  // namespace drives_test
}  // namespace tandem::mbd
