// Couplers of any coordinates, ropes, and forces over a joint coordinate, against closed forms and
// independent integrations.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/log.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace elements_test {

using scene::JointCoordinate;
using scene::JointType;

void expect_close(const char* what, double measured, double expected, double tolerance) {
  std::printf("  %-58s expected %15.10g measured %15.10g error %9.2e tolerance %7.1e\n", what, expected,
              measured, std::abs(measured - expected), tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

// Runge and Kutta's method of fourth order.
template <std::size_t n>
std::array<double, n> integrate(
    std::array<double, n> y, double end, int steps,
    const std::function<std::array<double, n>(double, const std::array<double, n>&)>& f) {
  const double h = end / steps;
  const auto moved = [](std::array<double, n> x, double by, const std::array<double, n>& d) {
    for (std::size_t i = 0; i < n; ++i) x[i] += by * d[i];
    return x;
  };
  for (int k = 0; k < steps; ++k) {
    const double t = k * h;
    const auto a = f(t, y), b = f(t + h / 2, moved(y, h / 2, a)), c = f(t + h / 2, moved(y, h / 2, b)),
               d = f(t + h, moved(y, h, c));
    for (std::size_t i = 0; i < n; ++i) y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
  return y;
}

// A run through the solver as a participant; its energy balance is in the report.
double energy_residual(scene::Scene scene, double end, int windows) {
  log::setup("test", "error");
  scene.coupling.window = end / windows;
  MbdSolver solver;
  solver.configure(scene);
  protocol::LoadSet loads;
  for (int n = 0; n < windows; ++n) {
    loads.window = {static_cast<std::uint64_t>(n), to_nanoseconds(n * end / windows),
                    to_nanoseconds((n + 1) * end / windows)};
    solver.advance(loads);
  }
  return nlohmann::json::parse(solver.report().facts).at("mbd_energy_balance_J").get<double>();
}

// ---- couplers

// A differential: the cage turns at the mean of both shafts. T on the cage gives each shaft T/2, so that
// q_i'' = T_i' / J_i with the multiplier of the cage's equation.
TEST(Couplers, DifferentialSharesTheTorque) {
  const double Jl = .03, Jr = .05, Jc = .2, T = 2, brake = .4;
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId left = machines::add_body(scene, "left", 1, {Jl, Jl, Jl}, {0, 1, 0}),
               right = machines::add_body(scene, "right", 1, {Jr, Jr, Jr}, {0, -1, 0}),
               cage = machines::add_body(scene, "cage", 1, {Jc, Jc, Jc}, {0, 0, 0});
  machines::add_joint(scene, "l", JointType::revolute, ground, left, {0, 1, 0}, {0, 1, 0});
  machines::add_joint(scene, "r", JointType::revolute, ground, right, {0, -1, 0}, {0, 1, 0});
  machines::add_joint(scene, "c", JointType::revolute, ground, cage, {0, 0, 0}, {0, 1, 0});
  scene::Coupler differential{"differential", scene::CouplerType::linear, {}, {}, 1};
  differential.terms = {{JointId{0}, JointCoordinate::angle, .5},
                        {JointId{1}, JointCoordinate::angle, .5},
                        {JointId{2}, JointCoordinate::angle, -1}};
  scene.mbd->couplers.push_back(differential);
  scene.mbd->forces.push_back(scene::Actuator{"engine", JointId{2}, scene::ConstantMotion{T, 0}});
  scene.mbd->forces.push_back(scene::Actuator{"brake", JointId{0}, scene::ConstantMotion{-brake, 0}});
  // With the force L of the equation: Jl l'' = L/2 - brake, Jr r'' = L/2, Jc (l'' + r'') / 2 = T - L.
  const double L = (T + Jc / 2 * brake / Jl) / (1 + Jc / 4 * (1 / Jl + 1 / Jr));
  const double l = (L / 2 - brake) / Jl, r = L / 2 / Jr, t = 1.5;
  machines::Run run(scene, 1e-2);
  run.advance(150);
  expect_close("differential: left shaft [rad]", run.state.q[0], l * t * t / 2, 1e-9);
  expect_close("differential: right shaft [rad]", run.state.q[1], r * t * t / 2, 1e-9);
  expect_close("differential: cage less the mean [rad]",
               run.state.q[2] - .5 * (run.state.q[0] + run.state.q[1]), 0, 1e-13);
}

// A tube on a cylindrical joint, whose displacement follows the angle of a wheel, while its own angle is
// free: with the ratio p it adds m p^2 to the inertia of the wheel. The parent and the child of the joint in
// both orders.
TEST(Couplers, CylindricalJointHasTwoCoordinates) {
  const double J = .02, m = 3, p = -.15, T = .7, Jt = .04, spin = .3;
  for (const bool reversed : {false, true}) {
    scene::Scene scene = machines::empty({0, 0, 0});
    const BodyId wheel = machines::add_body(scene, "wheel", 1, {J, J, J}, {0, 0, 0}),
                 tube = machines::add_body(scene, "tube", m, {Jt, Jt, Jt}, {1, 0, 0});
    machines::add_joint(scene, "axle", JointType::revolute, ground, wheel, {0, 0, 0}, {0, 0, 1});
    BodyId from = ground, to = tube;
    if (reversed) {
      const BodyId foot = machines::add_body(scene, "foot", 1, {1, 1, 1}, {1, 0, 0});
      machines::add_joint(scene, "weld", JointType::fixed, ground, foot, {1, 0, 0});
      from = tube, to = foot;
    }
    machines::add_joint(scene, "tube", JointType::cylindrical, from, to, {1, 0, 0}, {1, 0, 0});
    scene::Coupler coupler{"screw", scene::CouplerType::linear, {}, {}, 1};
    const std::uint32_t joint = reversed ? 2 : 1;
    // Seen from the child, the coordinates of the joint have the same sign.
    coupler.terms = {{JointId{0}, JointCoordinate::angle, p},
                     {JointId{joint}, JointCoordinate::displacement, -1}};
    scene.mbd->couplers.push_back(coupler);
    scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, scene::ConstantMotion{T, 0}});
    scene::BodyLoad twist{"twist", scene::BodyLoad::Kind::torque, tube, {}, {1, 0, 0},
                          false,   scene::ConstantMotion{spin, 0}};
    scene.mbd->forces.push_back(twist);
    machines::Run run(scene, 1e-2);
    run.advance(100);
    const double q = T / (J + m * p * p) / 2;
    expect_close(reversed ? "reversed: wheel [rad]" : "wheel [rad]", run.state.q[0], q, 1e-9);
    // The child of the reversed joint stands still, and its parent moves the other way.
    expect_close("tube along its axis [m]", run.position(1).x() - 1, (reversed ? -1 : 1) * p * q, 1e-10);
    run.system.residual(run.state);
    expect_close("tube about its axis [rad/s]", observe_body(run.model, run.system.links(), 1).twist.w_WB.x,
                 spin / Jt, 1e-9);
  }
}

// A cam of constant speed drives a follower on a spring: the torque on the shaft is dE/da.
TEST(Couplers, CamMovesItsFollower) {
  const double w = 3, m = 2, k = 40, lift = .05;
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId shaft = machines::add_body(scene, "shaft", 1, {.1, .1, .1}, {0, 0, 0}),
               follower = machines::add_body(scene, "follower", m, {1, 1, 1}, {0, 0, 1});
  machines::add_joint(scene, "a", JointType::revolute, ground, shaft, {0, 0, 0}, {0, 1, 0}).motion =
      scene::ConstantMotion{0, w};
  machines::add_joint(scene, "b", JointType::prismatic, ground, follower, {0, 0, 1}, {0, 0, 1});
  scene::Coupler cam{"cam", scene::CouplerType::cam, {}, {}, 1};
  cam.terms = {{JointId{0}}, {JointId{1}}};
  cam.table = scene::CamTable{{}, {}, 2 * std::numbers::pi};
  constexpr int points = 360;
  for (int i = 0; i <= points; ++i) {
    cam.table->arguments.push_back(2 * std::numbers::pi * i / points);
    cam.table->values.push_back(lift * (1 - std::cos(2 * std::numbers::pi * (i % points) / points)));
  }
  scene.mbd->couplers.push_back(cam);
  scene.mbd->forces.push_back(scene::SpringDamper{"spring", ground, follower, {0, 0, 3}, {0, 0, 1}, k, 0, 2});
  machines::Run run(scene, 2e-3);
  double worst = 0, effort = 0;
  for (int i = 0; i < 2500; ++i) {
    run.advance(1);
    const double a = w * run.state.time;
    worst = std::max(worst, std::abs(run.state.q[0] - lift * (1 - std::cos(a))));
    // The multiplier is the force on the follower, m q'' + k q.
    const double force = m * lift * w * w * std::cos(a) + k * lift * (1 - std::cos(a));
    effort = std::max(effort, std::abs(std::abs(run.state.lambda[0]) - std::abs(force)));
  }
  expect_close("cam: follower less lift (1 - cos a), largest [m]", worst, 0, 1e-6);
  expect_close("cam: force less m q'' + k q, largest [N]", effort, 0, 1e-2);
  expect_close("cam: residual of the energy [J]", energy_residual(scene, 5, 2500), 0, 1e-4);
}

// Free to move: a shaft with a cam and its follower are one freedom with the energy
// (J + m f'^2) a'^2 / 2 + m g f.
TEST(Couplers, CamMovesFreely) {
  const double J = .02, m = 2, lift = .08, g = 9.81, w0 = 9, end = 2;
  scene::Scene scene = machines::empty();
  const BodyId shaft = machines::add_body(scene, "shaft", 1, {J, J, J}, {0, 0, 0}),
               follower = machines::add_body(scene, "follower", m, {1, 1, 1}, {0, 0, 1});
  machines::add_joint(scene, "a", JointType::revolute, ground, shaft, {0, 0, 0}, {0, 1, 0}).rate = w0;
  machines::add_joint(scene, "b", JointType::prismatic, ground, follower, {0, 0, 1}, {0, 0, 1});
  scene::Coupler cam{"cam", scene::CouplerType::cam, {}, {}, 1};
  cam.terms = {{JointId{0}}, {JointId{1}}};
  cam.table = scene::CamTable{{}, {}, 2 * std::numbers::pi};
  constexpr int points = 720;
  for (int i = 0; i <= points; ++i) {
    cam.table->arguments.push_back(2 * std::numbers::pi * i / points);
    cam.table->values.push_back(lift * (1 - std::cos(2 * std::numbers::pi * (i % points) / points)));
  }
  scene.mbd->couplers.push_back(cam);
  const auto exact = integrate<2>({0, w0}, end, 20000, [&](double, const std::array<double, 2>& y) {
    const double s = lift * std::sin(y[0]), c = lift * std::cos(y[0]);
    return std::array<double, 2>{y[1], -(m * s * c * y[1] * y[1] + m * g * s) / (J + m * s * s)};
  });
  double last = 0;
  for (const double step : {2e-3, 1e-3}) {
    machines::Run run(scene, step);
    run.advance(static_cast<int>(std::lround(end / step)));
    expect_close("free cam: angle [rad]", run.state.q[0], exact[0], 3e3 * step * step);
    const double error = std::abs(run.state.q[0] - exact[0]);
    if (last > 0) expect_close("free cam: order", std::log2(last / error), 2, .2);
    last = error;
  }
}

// ---- ropes

// Two weights on a rope over two eyelets: a = (m1 - m2) g / (m1 + m2), T = 2 m1 m2 g / (m1 + m2), while the
// rope vibrates about its mean length with little amplitude. Its start at that length is at rest.
scene::Scene two_weights(double m1, double m2, double EA, double length) {
  scene::Scene scene = machines::empty();
  const BodyId a = machines::add_body(scene, "a", m1, {1, 1, 1}, {0, 0, -1}),
               b = machines::add_body(scene, "b", m2, {1, 1, 1}, {1, 0, -1});
  machines::add_joint(scene, "left", JointType::prismatic, ground, a, {0, 0, -1});
  machines::add_joint(scene, "right", JointType::prismatic, ground, b, {1, 0, -1});
  scene.mbd->forces.push_back(scene::Rope{
      "rope", {{a, {0, 0, -1}}, {ground, {0, 0, 0}}, {ground, {1, 0, 0}}, {b, {1, 0, -1}}}, length, EA, 0});
  return scene;
}

TEST(Rope, CarriesTwoWeightsLikeAtwoodsMachine) {
  const double m1 = 3, m2 = 2, g = 9.81, T = 2 * m1 * m2 * g / (m1 + m2), EA = 1e7;
  // e = T L / EA, and L + e = 3.
  const double length = 3 / (1 + T / EA);
  machines::Run run(two_weights(m1, m2, EA, length), 1e-3);
  run.advance(300);
  const double a = (m1 - m2) / (m1 + m2) * g, t = .3;
  expect_close("Atwood: the heavy weight falls [m]", -run.state.q[0], a * t * t / 2, 1e-9);
  expect_close("Atwood: force on the ground [N]", m1 * (g + run.state.udot[0]), T, 1e-6 * T);
  EXPECT_LT(std::abs(energy_residual(two_weights(m1, m2, EA, length), .3, 300)), 1e-8);
}

// A block and tackle with n strands lifts n times the weight: equilibrium with a movable block.
TEST(Rope, TackleMultipliesTheForce) {
  const int strands = 4;
  const double m = 2, g = 9.81, EA = 1e6;
  scene::Scene scene = machines::empty();
  const BodyId load = machines::add_body(scene, "load", strands * m, {1, 1, 1}, {0, 0, -2}),
               weight = machines::add_body(scene, "weight", m, {1, 1, 1}, {1, 0, -1});
  machines::add_joint(scene, "l", JointType::prismatic, ground, load, {0, 0, -2});
  machines::add_joint(scene, "w", JointType::prismatic, ground, weight, {1, 0, -1});
  scene::Rope rope{"rope", {{ground, {0, 0, 0}}}, 0, EA, 0};
  for (int i = 0; i < strands / 2; ++i) {
    rope.points.push_back({load, {0, 0, -2}});
    rope.points.push_back({ground, {0, 0, 0}});
  }
  rope.points.push_back({ground, {1, 0, 0}});
  rope.points.push_back({weight, {1, 0, -1}});
  const double whole = strands * 2 + 1 + 1, T = m * g;
  rope.length = whole / (1 + T / EA);
  scene.mbd->forces.push_back(rope);
  machines::Run run(scene, 1e-2);
  run.advance(500);
  expect_close("tackle: the load rests [m]", run.state.q[0], 0, 1e-12);
  expect_close("tackle: the weight rests [m]", run.state.q[1], 0, 1e-12);
}

// A weight on a rope of a slack start falls freely, and then swings on the rope, which becomes slack again at
// each rebound. Against an integration of m z'' = -m g + T(e), with damping.
TEST(Rope, CatchesAFallAndBecomesSlack) {
  const double m = 1.5, EA = 3000, L = 1, c = .3, g = 9.81, end = 1.6;
  scene::Scene scene = machines::empty();
  const BodyId weight = machines::add_body(scene, "weight", m, {1, 1, 1}, {0, 0, -.5});
  machines::add_joint(scene, "rail", JointType::prismatic, ground, weight, {0, 0, -.5});
  scene.mbd->forces.push_back(scene::Rope{"rope", {{ground, {0, 0, 0}}, {weight, {0, 0, -.5}}}, L, EA, c});
  scene.mbd->integrator.error_tolerance = 1e-8;
  scene.mbd->integrator.step = .02;
  log::setup("test", "error");
  scene.coupling.window = .02;
  MbdSolver solver;
  solver.configure(scene);
  protocol::LoadSet loads;
  int slack = 0;
  bool was_slack = true;
  for (int n = 0; n < 80; ++n) {
    loads.window = {static_cast<std::uint64_t>(n), {n * 20'000'000LL}, {(n + 1) * 20'000'000LL}};
    solver.advance(loads);
    const bool is_slack = .5 - solver.state().q[0] < L;
    slack += is_slack && !was_slack;
    was_slack = is_slack;
  }
  const auto exact = integrate<2>({0, 0}, end, 1600000, [&](double, const std::array<double, 2>& y) {
    const double e = .5 - y[0] - L, rate = -y[1];
    const double T = e > 0 ? EA / L * e * std::max(0., 1 + c * rate) : 0;
    return std::array<double, 2>{y[1], -g + T / m};
  });
  std::printf("  the rope became slack %d times\n", slack);
  EXPECT_GE(slack, 2);
  expect_close("falling weight: place [m]", solver.state().q[0], exact[0], 2e-5);
  expect_close("falling weight: rate [m/s]", solver.state().u[0], exact[1], 3e-4);
  expect_close("falling weight: residual of the energy [J]",
               nlohmann::json::parse(solver.report().facts).at("mbd_energy_balance_J").get<double>(), 0,
               1e-4);
}

// A bead that slides along a rope between two points moves on an ellipse with the points as foci, and is in
// equilibrium where both spans have the same angle to the vertical.
TEST(Rope, HoldsABeadAtEqualAngles) {
  const double EA = 1e4;
  scene::Scene scene = machines::empty();
  const BodyId bead = machines::add_body(scene, "bead", 1, {1, 1, 1}, {.9, 0, -.4});
  const BodyId carrier = machines::add_body(scene, "carrier", .1, {1, 1, 1}, {.9, 0, 0});
  machines::add_joint(scene, "x", JointType::prismatic, ground, carrier, {.9, 0, 0}, {1, 0, 0}).damping = 3;
  machines::add_joint(scene, "z", JointType::prismatic, carrier, bead, {.9, 0, -.4}, {0, 0, 1}).damping = 3;
  scene.mbd->forces.push_back(
      scene::Rope{"rope", {{ground, {0, 0, 0}}, {bead, {.9, 0, -.4}}, {ground, {1.2, 0, .3}}}, 1.8, EA, .2});
  // The heights differ, and with equal angles A both spans together cover L (1 + T/EA) sin A = 1.2, where
  // 2 T cos A = m g.
  double angle = .7;
  for (int i = 0; i < 100; ++i) angle = std::asin(1.2 / 1.8 / (1 + 9.81 / (2 * std::cos(angle)) / EA));
  machines::Run run(scene, 1e-3);
  run.advance(20000);
  const Vector3d p = run.position(0);
  expect_close("bead: angle of the left span [rad]", std::atan2(p.x(), -p.z()), angle, 1e-9);
  expect_close("bead: angle of the right span [rad]", std::atan2(1.2 - p.x(), .3 - p.z()), angle, 1e-9);
}

// ---- sizes over a coordinate

// A flywheel with a torque over its angle, T(q) = T0 + T1 sin(q) by a table, and a load on another body over
// the same angle: m x'' = F(q).
TEST(Sizes, FollowAJointCoordinate) {
  const double J = .05, m = 2, end = 3;
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId wheel = machines::add_body(scene, "wheel", 1, {J, J, J}, {0, 0, 0}),
               block = machines::add_body(scene, "block", m, {1, 1, 1}, {1, 0, 0});
  machines::add_joint(scene, "axle", JointType::revolute, ground, wheel, {0, 0, 0}, {0, 0, 1}).rate = 4;
  machines::add_joint(scene, "rail", JointType::prismatic, ground, block, {1, 0, 0}, {1, 0, 0});
  scene::JointFunction sine{JointId{0}, false, {{}, {}}, 2 * std::numbers::pi};
  constexpr int points = 400;
  for (int i = 0; i <= points; ++i) {
    sine.table.arguments.push_back(2 * std::numbers::pi * i / points);
    sine.table.values.push_back(.3 * std::sin(2 * std::numbers::pi * (i % points) / points));
  }
  scene::Actuator motor{"motor", JointId{0}, scene::ConstantMotion{}};
  motor.over = sine;
  scene::BodyLoad push{"push", scene::BodyLoad::Kind::force, block, {1, 0, 0}, {1, 0, 0},
                       false,  scene::ConstantMotion{}};
  push.over = sine;
  scene::Actuator drag{"drag", JointId{1}, scene::ConstantMotion{}};
  drag.over = scene::JointFunction{JointId{0}, true, {{-100, 0, 100}, {10, 0, -10}}, {}};
  scene.mbd->forces = {motor, push, drag};
  const auto exact = integrate<4>({0, 4, 0, 0}, end, 30000, [&](double, const std::array<double, 4>& y) {
    return std::array<double, 4>{y[1], .3 * std::sin(y[0]) / J, y[3], (.3 * std::sin(y[0]) - .1 * y[1]) / m};
  });
  double last = 0;
  for (const double step : {1e-2, 5e-3}) {
    machines::Run run(scene, step);
    run.advance(static_cast<int>(std::lround(end / step)));
    expect_close("wheel [rad]", run.state.q[0], exact[0], 60 * step * step);
    expect_close("block [m]", run.state.q[1], exact[2], 60 * step * step);
    const double error = std::abs(run.state.q[0] - exact[0]);
    if (last > 0) expect_close("order", std::log2(last / error), 2, .25);
    last = error;
  }
  expect_close("residual of the energy [J]", energy_residual(scene, end, 3000), 0, 1e-4);
}

// A weight on a rope that a drum pays out, in whichever sense its axis points: an elastic rope between the
// inertia J of the drum and the mass m. With e its elongation, e'' = g - k e (1/m + R^2/J), and J q'' = R k
// e. The reaction of the bearing contains the tension.
TEST(Rope, ADrumPaysOut) {
  const double J = .8, m = 5, R = .3, k = 4000, g = 9.81, end = 1.3;
  const double w2 = k * (1 / m + R * R / J), w = std::sqrt(w2), mean = g / w2;
  // From rest with a slack-free rope: e = mean (1 - cos w t), and e stays above 0.
  const double angle = R * k / J * mean * (end * end / 2 - (1 - std::cos(w * end)) / w2);
  const double e = mean * (1 - std::cos(w * end));
  for (const double sense : {1., -1.}) {
    scene::Scene scene = machines::empty();
    const BodyId drum = machines::add_body(scene, "drum", 20, {J, J, J}, {0, 0, 4}),
                 weight = machines::add_body(scene, "weight", m, {1, 1, 1}, {R, 0, 1});
    machines::add_joint(scene, "bearing", JointType::revolute, ground, drum, {0, 0, 4}, {0, sense, 0});
    scene::Rope rope{"rope", {{ground, {R, 0, 4}}, {weight, {R, 0, 1}}}, 3, 3 * k, 0};
    rope.drum = JointId{0};
    scene.mbd->forces.push_back(rope);
    double last = 0;
    for (const double step : {1e-3, 5e-4}) {
      machines::Run run(scene, step);
      run.advance(static_cast<int>(std::lround(end / step)));
      const double error = std::abs(sense * run.joint("bearing").q - angle);
      expect_close("drum [rad]", sense * run.joint("bearing").q, angle, 50 * step * step);
      if (last > 0) expect_close("order", std::log2(last / error), 2, .15);
      last = error;
      expect_close("weight [m]", run.position(1).z() - 1, -R * angle - e, 25 * step * step);
      const auto bearing = run.joint("bearing").reaction;
      expect_close("bearing, weight of the drum and tension [N]", bearing.force.z, 20 * g + k * e, .2);
    }
    expect_close("residual of the energy [J]", energy_residual(scene, end, 1300), 0, 1e-3);
  }
}

// Gas on the piston of a slider-crank over the angle of its crank, with a cut joint, against an integration
// of the single freedom: (I(a) a')' - I' a'^2 / 2 = F(a) x'(a).
TEST(Sizes, GasOnAPistonOverTheAngleOfItsCrank) {
  const double r = .04, L = .14, m = .6, J = 5e-3, w0 = 60, end = .3;
  scene::Scene scene = machines::empty({0, 0, 0});
  // A massless rod would be singular; a light one adds 1e-6 of the inertia.
  const BodyId crank = machines::add_body(scene, "crank", 1, {J, J, J}, {0, 0, 0}),
               rod = machines::add_body(scene, "rod", 1e-6, {1e-9, 1e-9, 1e-9}, {r + L / 2, 0, 0}),
               piston = machines::add_body(scene, "piston", m, {1e-3, 1e-3, 1e-3}, {r + L, 0, 0});
  machines::add_joint(scene, "crank", JointType::revolute, ground, crank, {0, 0, 0}, {0, 0, 1}).rate = w0;
  machines::add_joint(scene, "pin", JointType::revolute, crank, rod, {r, 0, 0}, {0, 0, 1});
  machines::add_joint(scene, "end", JointType::revolute, rod, piston, {r + L, 0, 0}, {0, 0, 1}).cut = true;
  machines::add_joint(scene, "bore", JointType::prismatic, ground, piston, {r + L, 0, 0}, {1, 0, 0});
  const auto pressure = [](double a) { return -250 * std::exp(3 * (std::cos(a / 2 - .1) - 1)); };
  scene::BodyLoad gas{"gas", scene::BodyLoad::Kind::force, piston, {r + L, 0, 0}, {1, 0, 0},
                      true,  scene::ConstantMotion{}};
  gas.over = scene::JointFunction{JointId{0}, false, {{}, {}}, 4 * std::numbers::pi};
  constexpr int points = 720;
  for (int i = 0; i <= points; ++i) {
    gas.over->table.arguments.push_back(4 * std::numbers::pi * i / points);
    gas.over->table.values.push_back(pressure(4 * std::numbers::pi * (i % points) / points));
  }
  scene.mbd->forces.push_back(gas);
  const auto exact = integrate<2>({0, w0}, end, 60000, [&](double, const std::array<double, 2>& y) {
    const double s = std::sin(y[0]), c = std::cos(y[0]), root = std::sqrt(L * L - r * r * s * s);
    const double d = -r * s - r * r * s * c / root;
    const double dd =
        -r * c - r * r * (c * c - s * s) / root - r * r * r * r * s * s * c * c / (root * root * root);
    return std::array<double, 2>{y[1], (pressure(y[0]) * d - m * d * dd * y[1] * y[1]) / (J + m * d * d)};
  });
  double last = 0;
  for (const double step : {2e-4, 1e-4}) {
    machines::Run run(scene, step);
    run.advance(static_cast<int>(std::lround(end / step)));
    expect_close("crank [rad]", run.state.q[0], exact[0], 1e5 * step * step);
    const double error = std::abs(run.state.q[0] - exact[0]);
    if (last > 0) expect_close("order", std::log2(last / error), 2, .3);
    last = error;
  }
}

}  // namespace elements_test
}  // namespace tandem::mbd
