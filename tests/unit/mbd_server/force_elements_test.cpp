// Bushings, tabulated laws, loads and actuators in motion, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbd_server/io/observation.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace {

using machines::bead;
using scene::JointType;
constexpr double pi = std::numbers::pi;

// A spring along the rail, whose length is that of the scene at zero.
scene::SpringDamper along_rail() {
  return scene::SpringDamper{"law", ground, BodyId{0}, {-10, 0, 0}, {0, 0, 0}, 0, 0, 10};
}

scene::ForceTable sampled(double from, double to, int cells, double (*force)(double)) {
  scene::ForceTable table;
  for (int i = 0; i <= cells; ++i) {
    const double x = from + (to - from) * i / cells;
    table.arguments.push_back(x);
    table.values.push_back(force(x));
  }
  return table;
}

// A table on a straight line is a spring of that stiffness, up to round-off.
TEST(Tables, OnALineAreALinearSpring) {
  scene::Scene linear = bead(1, .8), table = bead(1, .8);
  scene::SpringDamper spring = along_rail();
  spring.stiffness = 50, spring.damping = 2;
  linear.mbd->forces.push_back(spring);
  spring.stiffness = spring.damping = 0;
  spring.table = scene::ForceTable{{-1, -.3, .1, .7}, {-50, -15, 5, 35}};
  spring.damping_table = scene::ForceTable{{-2, -.1, 0, .5}, {-4, -.2, 0, 1}};
  table.mbd->forces.push_back(spring);
  machines::Run a(linear, 1e-3), b(table, 1e-3);
  a.advance(2000), b.advance(2000);
  EXPECT_NEAR(a.state.q[0], b.state.q[0], 1e-14);
  a.system.residual(a.state), b.system.residual(b.state);
  EXPECT_NEAR(energy(a.model, a.state, a.system.links()), energy(b.model, b.state, b.system.links()), 1e-14);
}

// Duffing's oscillator x'' = -alpha x - beta x^3: period 4 K(k) / sqrt(alpha + beta A^2),
// k^2 = beta A^2 / 2 (alpha + beta A^2).
TEST(Tables, GiveDuffingItsPeriod) {
  constexpr double alpha = 40, beta = 900, A = .3;
  const double stiff = alpha + beta * A * A;
  const double exact = 4 * std::comp_ellint_1(std::sqrt(beta * A * A / (2 * stiff))) / std::sqrt(stiff);
  scene::Scene scene = bead(1, 0);
  scene::SpringDamper spring = along_rail();
  spring.table = sampled(-.4, .4, 400, [](double x) { return 40 * x + 900 * x * x * x; });
  scene.mbd->forces.push_back(spring);
  machines::Run run(scene, 2e-4, 1);
  run.restart([](State& s) { s.q[0] = A; });
  double first = 0, last = 0;
  int periods = -1;
  while (periods < 10) {
    const double before = run.state.q[0];
    run.advance(1);
    const double now = run.state.q[0];
    if (!(before < 0 && now >= 0)) continue;
    last = run.state.time - run.step * now / (now - before);
    if (++periods == 0) first = last;
  }
  const double period = (last - first) / 10;
  std::printf("Duffing by a table of 400 cells: period %.8f s, exact %.8f s, tolerance 1e-5\n", period,
              exact);
  EXPECT_NEAR(period, exact, 1e-5 * exact);
}

// Drag c v |v|: v = v0 / (1 + c v0 t / m).
TEST(Tables, GiveQuadraticDrag) {
  const double m = 2, c = 3, v0 = 4, t = 1.5;
  scene::Scene scene = bead(m, v0);
  scene::SpringDamper drag = along_rail();
  drag.damping_table = sampled(-5, 5, 1000, [](double v) { return 3 * v * std::abs(v); });
  scene.mbd->forces.push_back(drag);
  machines::Run run(scene, 5e-4);
  run.advance(3000);
  const double v = v0 / (1 + c * v0 * t / m), x = m / c * std::log(1 + c * v0 * t / m);
  std::printf("quadratic drag: %.9f m/s, exact %.9f; %.9f m, exact %.9f\n", run.state.u[0], v, run.state.q[0],
              x);
  EXPECT_NEAR(run.state.u[0], v, 2e-6 * v);
  EXPECT_NEAR(run.state.q[0], x, 2e-6 * x);
}

// Torque k sin(q) on a wheel as a table: a pendulum, here A01 from the horizontal, k / J = 9.81 / s2.
TEST(Tables, OnAnAngleAreAPendulum) {
  const double J = .25;
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId wheel = machines::add_body(scene, "wheel", 1, {J, J, J}, {0, 0, 0});
  machines::add_joint(scene, "axle", JointType::revolute, ground, wheel, {0, 0, 0});
  scene::RotationalSpringDamper spring{"torsion", JointId{0}};
  spring.table = sampled(-2, 2, 1000, [](double x) { return .25 * 9.81 * std::sin(x); });
  scene.mbd->forces.push_back(spring);
  machines::Run run(scene, 2e-4);
  run.restart([](State& s) { s.q[0] = -pi / 2; });
  run.advance(5000);
  EXPECT_NEAR(std::sin(run.state.q[0]), 0.986291751131875, 1e-6);
  EXPECT_NEAR(std::cos(run.state.q[0]), 0.165010853125541, 5e-6);
}

// ---- bushing

scene::Scene mounted(double m, double J, const scene::Bushing& bushing, Vec3d gravity) {
  scene::Scene scene = machines::empty(gravity);
  machines::add_body(scene, "engine", m, {J, J, J}, {0, 0, 0});
  scene.mbd->forces.push_back(bushing);
  return scene;
}

scene::Bushing diagonal(double k, double c, double k_turn, double c_turn) {
  scene::Bushing bushing{"mount", ground, BodyId{0}, {0, 0, 0}, {}, {}};
  for (std::size_t i = 0; i < 6; ++i) {
    bushing.stiffness[7 * i] = i < 3 ? k : k_turn;
    bushing.damping[7 * i] = i < 3 ? c : c_turn;
  }
  return bushing;
}

// Displaced along x and rotated about z by 0.8 rad: two damped oscillators, both exactly linear.
TEST(Bushing, SwingsAsADampedOscillator) {
  const double m = 2, J = .1, k = 300, c = 4, kt = 8, ct = .05, t = 1, d0 = .2, a0 = .8;
  const auto swing = [t](double x0, double inertia, double stiffness, double damping) {
    const double delta = damping / (2 * inertia), w = std::sqrt(stiffness / inertia - delta * delta);
    return x0 * std::exp(-delta * t) * (std::cos(w * t) + delta / w * std::sin(w * t));
  };
  OrderTable table("bushing at t = 1 s: displacement [m], angle [rad]");
  for (int n = 250; n <= 2000; n *= 2) {
    machines::Run run(mounted(m, J, diagonal(k, c, kt, ct), {0, 0, 0}), t / n);
    const LinkIndex turning = run.model.bodies[0].link, sliding = run.model.links[turning].parent;
    const int q_slide = run.model.links[sliding].q, q_turn = run.model.links[turning].q;
    run.restart([&](State& s) {
      s.q[q_slide] = d0;
      s.q[q_turn] = std::cos(a0 / 2), s.q[q_turn + 3] = std::sin(a0 / 2);
    });
    run.advance(n);
    const double angle = 2 * std::atan2(run.state.q[q_turn + 3], run.state.q[q_turn]);
    table.add(t / n,
              {std::abs(run.state.q[q_slide] - swing(d0, m, k, c)), std::abs(angle - swing(a0, J, kt, ct))});
  }
  table.expect_order(2, .1);
}

// At rest the full matrix carries the weight: K [d; a] = [m g; 0].
TEST(Bushing, OfAFullMatrixSagsAsItsInverseSays) {
  scene::Bushing bushing = diagonal(3e4, 400, 900, 12);
  const auto couple = [&](std::size_t i, std::size_t j, double value) {
    bushing.stiffness[6 * i + j] = bushing.stiffness[6 * j + i] = value;
  };
  couple(2, 3, 800), couple(2, 4, -500), couple(0, 2, 4000), couple(1, 5, 300);
  machines::Run run(mounted(5, .2, bushing, {0, 0, -9.81}), 2e-3, .5);
  run.advance(4000);
  const Matrix6d K = Eigen::Map<const Matrix6d>(bushing.stiffness.data());
  Vector6d weight = Vector6d::Zero();
  weight[2] = -5 * 9.81;
  const Vector6d exact = K.inverse() * weight;
  run.system.residual(run.state);
  const Pose pose = observe_body(run.model, run.system.links(), 0).pose;
  const Vector3d turn = to_eigen(rotation_vector(pose.q_WB));
  std::printf("sag of %.6e m and %.6e rad; exact %.6e m, %.6e rad\n", pose.p_WB.z, turn.norm(), exact[2],
              exact.tail<3>().norm());
  EXPECT_LT((to_eigen(pose.p_WB) - exact.head<3>()).norm(), 1e-12);
  EXPECT_LT((turn - exact.tail<3>()).norm(), 1e-12);
}

// ---- loads and actuators

// A force that follows a body rotating at constant rate w: v = F / (m w) (sin wt, 1 - cos wt).
TEST(Loads, FollowTheBodyOrTheWorld) {
  const double m = 2, w = 3, F = 5, t = 2;
  for (const bool follows : {true, false}) {
    scene::Scene scene = machines::free_body(m, {.1, .1, .1}, {0, 0, 0});
    scene.mbd->bodies[0].twist.w_WB = {0, 0, w};
    scene.mbd->forces.push_back(scene::BodyLoad{"thrust",
                                                scene::BodyLoad::Kind::force,
                                                BodyId{0},
                                                {0, 0, 0},
                                                {1, 0, 0},
                                                follows,
                                                scene::ConstantMotion{F, 0}});
    machines::Run run(scene, 2e-4);
    run.advance(10000);
    const Vector3d v = run.velocity(0);
    const Vector3d exact =
        follows ? Vector3d(F / (m * w) * std::sin(w * t), F / (m * w) * (1 - std::cos(w * t)), 0)
                : Vector3d(F / m * t, 0, 0);
    std::printf("%s force: velocity (%.8f, %.8f), exact (%.8f, %.8f)\n", follows ? "following" : "constant",
                v.x(), v.y(), exact.x(), exact.y());
    EXPECT_LT((v - exact).norm(), 1e-6);
  }
}

// A force away from the centre of mass rotates the body: F r / J.
TEST(Loads, TurnABodyAboutItsCentre) {
  const double J = .5, F = 2, r = .3, t = .1;
  scene::Scene scene = machines::free_body(2, {J, J, J}, {0, 0, 0});
  scene.mbd->forces.push_back(scene::BodyLoad{"push",
                                              scene::BodyLoad::Kind::force,
                                              BodyId{0},
                                              {r, 0, 0},
                                              {0, 1, 0},
                                              true,
                                              scene::ConstantMotion{F, 0}});
  scene.mbd->forces.push_back(scene::BodyLoad{
      "wring", scene::BodyLoad::Kind::torque, BodyId{0}, {}, {1, 0, 0}, false, scene::ConstantMotion{0, 3}});
  machines::Run run(scene, 1e-3);
  run.advance(100);
  run.system.residual(run.state);
  const Twist twist = observe_body(run.model, run.system.links(), 0).twist;
  EXPECT_NEAR(twist.w_WB.x, 3 * t * t / 2 / J, 1e-4);  // the force rotates with the body: not quite about z
  EXPECT_NEAR(twist.w_WB.z, F * r / J * t, 1e-4);
}

// J q'' = T(t) for each kind of function; the table is a straight line.
TEST(Actuators, TurnAWheelAsTheirFunctionSays) {
  const double J = .4;
  struct Case {
    const char* name;
    scene::Motion torque;
    double rate, angle;  // at t
  };
  const double w = 2 * pi * 1.5;
  const Case cases[] = {
      {"constant", scene::ConstantMotion{2, 0}, 2 / J, 1 / J},
      {"rising", scene::ConstantMotion{0, 3}, 1.5 / J, .5 / J},
      {"harmonic", scene::HarmonicMotion{1, .5, 1.5, 0}, (1 + .5 * (1 - std::cos(w)) / w) / J,
       (.5 + .5 * (1 - std::sin(w) / w) / w) / J},
      // The integral over the ramp is half its height, as its graph is point-symmetric.
      {"ramp", scene::RampMotion{0, 2, .2, .4}, (.4 + .8) / J, 0},
      {"table", scene::TableMotion{{0, .3, 1}, {1, 1.6, 3}, scene::Interpolation::spline}, 2 / J,
       (.5 + 1. / 3) / J},
  };
  for (const Case& c : cases) {
    scene::Scene scene = machines::empty();
    const BodyId wheel = machines::add_body(scene, "wheel", 1, {J, J, J}, {0, 0, 0});
    machines::add_joint(scene, "axle", JointType::revolute, ground, wheel, {0, 0, 0});
    scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, c.torque});
    machines::Run run(scene, 1e-3);
    run.advance(1000);
    std::printf("%-10s rate %.9f, exact %.9f; angle %.9f, exact %.9f\n", c.name, run.state.u[0], c.rate,
                run.state.q[0], c.angle);
    EXPECT_NEAR(run.state.u[0], c.rate, 2e-6 * c.rate);
    if (c.angle > 0) {
      EXPECT_NEAR(run.state.q[0], c.angle, 2e-6 * c.angle);
    }
  }
}

}  // namespace
}  // namespace tandem::mbd
