// Hydraulic cylinders against linear solutions, steady states and a fine integration of their equations.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "mbd_server/step/step_control.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace hydraulics_test {

// A mass on a level rail, pushed by a cylinder of 1 m that may extend and retract by 0.3 m.
struct Rig {
  double mass = 200, load = -5e3, damping = 0, lower = -.3;
  scene::HydraulicData oil;
  scene::Motion opening = scene::ConstantMotion{.5, 0};

  Rig() {
    oil.bore_area = 2e-3, oil.rod_area = 8e-4, oil.dead_volume = 1e-4;
    oil.supply_pressure = 15e6, oil.tank_pressure = 2e5;
    oil.valve_flow = 1e-3, oil.laminar_drop = 1e4;
    oil.pressure_a = 4e6, oil.pressure_b = 2e6;
  }
  scene::Scene scene() const {
    scene::Scene s = machines::empty({0, 0, 0});
    const BodyId body = machines::add_body(s, "mass", mass, {1, 1, 1}, {1, 0, 0});
    machines::add_joint(s, "rail", scene::JointType::prismatic, ground, body, {1, 0, 0}, {1, 0, 0});
    scene::Cylinder c;
    c.name = "jack", c.body_b = body, c.point_b = {1, 0, 0};
    c.control = scene::CylinderControl::valve, c.target = opening, c.hydraulics = oil, c.damping = damping;
    c.limits = scene::Limits{lower, .3, 1e9, 0};
    s.mbd->forces.push_back(c);
    s.mbd->forces.push_back(scene::Actuator{"load", JointId{0}, scene::ConstantMotion{load, 0}});
    return s;
  }
  double opened(double t) const {
    if (const auto* ramp = std::get_if<scene::RampMotion>(&opening)) {
      const double x = std::clamp((t - ramp->start) / ramp->duration, 0., 1.);
      return ramp->from + (ramp->to - ramp->from) * x * x * x * (10 + x * (6 * x - 15));
    }
    return std::get<scene::ConstantMotion>(opening).value;
  }
  double edge(double x, double drop) const {
    const double d = oil.laminar_drop,
                 K = oil.valve_flow / oil.valve_drop * std::pow(oil.valve_drop * oil.valve_drop + d * d, .25);
    return K * x * drop / std::pow(drop * drop + d * d, .25);
  }
  // Classical Runge-Kutta of stroke, rate and the two pressures.
  using Y = Eigen::Vector4d;
  Y rate(double t, const Y& y) const {
    const double Aa = oil.bore_area, Ab = oil.bore_area - oil.rod_area, x = opened(t);
    const double Va = oil.dead_volume + Aa * (y[0] - lower), Vb = oil.dead_volume + Ab * (.3 - y[0]);
    const double ps = oil.supply_pressure, pt = oil.tank_pressure;
    double Qa = x >= 0 ? edge(x, ps - y[2]) : edge(-x, pt - y[2]);
    double Qb = x >= 0 ? edge(x, pt - y[3]) : edge(-x, ps - y[3]);
    if (oil.pump_flow) (x >= 0 ? Qa : Qb) = std::min(x >= 0 ? Qa : Qb, *oil.pump_flow);
    const double leak = oil.leakage * (y[2] - y[3]);
    return {y[1], (Aa * y[2] - Ab * y[3] - damping * y[1] + load) / mass,
            oil.bulk_modulus / Va * (Qa - leak - Aa * y[1]), oil.bulk_modulus / Vb * (Qb + leak + Ab * y[1])};
  }
  Y fine(double end, int steps) const {
    Y y(0, 0, *oil.pressure_a, *oil.pressure_b);
    const double h = end / steps;
    for (int i = 0; i < steps; ++i) {
      const double t = i * h;
      const Y a = rate(t, y), b = rate(t + h / 2, y + h / 2 * a), c = rate(t + h / 2, y + h / 2 * b),
              d = rate(t + h, y + h * c);
      y += h / 6 * (a + 2 * b + 2 * c + d);
    }
    return y;
  }
  // At the end of a run in n steps.
  Y run(double end, int n, double rho = .8) const {
    machines::Run r(scene(), end / n, rho, {1e-12, 30});
    r.advance(n);
    EXPECT_EQ(r.integrator.shortened().count, 0u);
    return {r.state.q[0], r.state.u[0], r.state.z[0], r.state.z[1]};
  }
};

std::vector<double> errors(const Rig::Y& found, const Rig::Y& exact) {
  const Rig::Y e = (found - exact).cwiseAbs();
  return {e[0], e[1], e[2], e[3]};
}
const std::vector<std::string> columns{"stroke [m]", "rate [m/s]", "p_a [Pa]", "p_b [Pa]"};

// Laminar edges, a stroke that hardly changes the volumes: a linear system of four equations.
TEST(Hydraulics, ASmallStepIsThatOfTheLinearSystem) {
  Rig rig;
  rig.oil.laminar_drop = 1e12, rig.oil.valve_flow = 5e-10, rig.oil.dead_volume = 1e-1, rig.load = 0;
  rig.oil.supply_pressure = 1e5, rig.oil.tank_pressure = 0, rig.oil.pressure_a = rig.oil.pressure_b = 1e4;
  rig.oil.leakage = 2e-9, rig.oil.valve_drop = 1e5, rig.oil.valve_flow = 1e-3, rig.damping = 1e3;
  const double G = rig.edge(.5, 1), Aa = 2e-3, Ab = 1.2e-3, B = 1.5e9, k = 2e-9;
  const double Va = .1 + .3 * Aa, Vb = .1 + .3 * Ab;
  Eigen::Matrix4d M;
  M << 0, 1, 0, 0, 0, -5, Aa / 200, -Ab / 200, 0, -B * Aa / Va, -B * (G + k) / Va, B * k / Va, 0, B * Ab / Vb,
      B * k / Vb, -B * (G + k) / Vb;
  const Eigen::Vector4d f(0, 0, B * G * 1e5 / Va, 0), p(0, 0, 1e4, 1e4);
  const double t = .5;
  Eigen::Matrix<double, 5, 5> W = Eigen::Matrix<double, 5, 5>::Zero();
  W.topLeftCorner<4, 4>() = M * t, W.topRightCorner<4, 1>() = f * t;
  const Eigen::Matrix<double, 5, 5> E = W.exp();
  const Rig::Y exact = E.topLeftCorner<4, 4>() * p + E.topRightCorner<4, 1>();
  const Rig::Y found = rig.run(t, 4000);
  std::printf("%-12s %16s %16s %10s\n", "linear step", "expected", "measured", "tolerance");
  for (int i = 0; i < 4; ++i) {
    const double tolerance = 2e-4 * std::abs(exact[i]);
    std::printf("%-12s %16.9e %16.9e %10.1e\n", columns[i].c_str(), exact[i], found[i], tolerance);
    EXPECT_NEAR(found[i], exact[i], tolerance);
  }
}

// Against Runge-Kutta with steps of 2 us, which resolve the oil's own vibration: order two.
TEST(Hydraulics, AValveThatOpensIsOfOrderTwo) {
  Rig rig;
  rig.opening = scene::RampMotion{0, .6, 0, .2, {}, 0};
  rig.oil.leakage = 1e-11, rig.damping = 2e3;
  const double t = .2;
  const Rig::Y exact = rig.fine(t, 100'000);
  for (const double rho : {.5, .8}) {
    OrderTable table("valve that opens, t = 0.2 s, rho_inf = " + std::to_string(rho), columns);
    for (int n = 800; n <= 6400; n *= 2) table.add(t / n, errors(rig.run(t, n, rho), exact));
    table.expect_order(2.0, 0.15);
  }
}

// 1 cm3 of oil is left at the end of the stroke. There the oil's own vibration is far above the step of 1 ms,
// which must follow the flow, and the pressures must not vibrate by themselves.
TEST(Hydraulics, StiffestOilAtAStepOfAMillisecond) {
  Rig rig;
  rig.oil.dead_volume = 1e-6, rig.mass = 20, rig.lower = -.02;
  rig.opening = scene::RampMotion{0, -.4, 0, .1, {}, 0};
  machines::Run run(rig.scene(), 1e-3, .5, {1e-10, 20});
  const double w = 2e-3 * std::sqrt(1.5e9 / (1e-6 * 20));
  std::printf("frequency of 1 cm3 of oil times the step: %.1f\n", 1e-3 * w);
  run.advance(100);
  const Rig::Y fine = rig.fine(.1, 400'000);
  std::printf("%-12s %16s %16s %10s\n", "at t = 0.1 s", "fine", "measured", "tolerance");
  const double found[]{run.state.q[0], run.state.u[0], run.state.z[0], run.state.z[1]};
  for (int i = 0; i < 4; ++i) {
    const double tolerance = 1e-2 * std::abs(fine[i]);
    std::printf("%-12s %16.9e %16.9e %10.1e\n", columns[i].c_str(), fine[i], found[i], tolerance);
    EXPECT_NEAR(found[i], fine[i], tolerance);
  }
  EXPECT_EQ(run.integrator.shortened().count, 0u);
  // At the end of the stroke the valve stays open, and the end stop bears the force.
  run.advance(2000);
  std::printf("at its end: stroke %.9f m, p_a %.6e, p_b %.6e Pa, rate %.1e m/s\n", run.state.q[0],
              run.state.z[0], run.state.z[1], run.state.u[0]);
  EXPECT_NEAR(run.state.q[0], -.02 - (15e6 * 1.2e-3 - 2e5 * 2e-3 + 5e3) / 1e9, 1e-6);
  EXPECT_NEAR(run.state.z[1], 15e6, 1e2);
  EXPECT_NEAR(run.state.z[0], 2e5, 1e2);
}

// Without acceleration both edges throttle: v = K sqrt((p_s A_a - p_t A_b + load) / (A_a^3 + A_b^3)).
TEST(Hydraulics, SteadyRateIsThatOfTheEdges) {
  Rig rig;
  rig.opening = scene::ConstantMotion{.2, 0};
  rig.damping = 0, rig.oil.laminar_drop = 1e3;
  const double K = .2 * 1e-3 / std::sqrt(3.5e6), Aa = 2e-3, Ab = 1.2e-3;
  const double v = K * std::sqrt((15e6 * Aa - 2e5 * Ab - 5e3) / (Aa * Aa * Aa + Ab * Ab * Ab));
  const Rig::Y y = rig.run(1, 4000);
  std::printf("steady rate %.9f, expected %.9f m/s, tolerance 1e-6\n", y[1], v);
  EXPECT_NEAR(y[1], v, 1e-6);
  const double pa = 15e6 - std::pow(Aa * v / K, 2), pb = 2e5 + std::pow(Ab * v / K, 2);
  std::printf("pressures %.4f %.4f, expected %.4f %.4f Pa, tolerance 200\n", y[2], y[3], pa, pb);
  EXPECT_NEAR(y[2], pa, 200);
  EXPECT_NEAR(y[3], pb, 200);
}

TEST(Hydraulics, ThePumpLimitsTheRate) {
  Rig rig;
  rig.opening = scene::ConstantMotion{1, 0};
  rig.oil.pump_flow = 1e-4, rig.damping = 4e3;
  const Rig::Y y = rig.run(1, 4000), exact = rig.fine(1, 500'000);
  std::printf("rate with a pump of 1e-4 m3/s: %.9f, expected %.9f m/s, tolerance 1e-5; fine %.9f\n", y[1],
              1e-4 / 2e-3, exact[1]);
  EXPECT_NEAR(y[1], 1e-4 / 2e-3, 1e-5);
  EXPECT_NEAR(y[2], exact[2], 1e-3 * 15e6);
}

// The error control sees the pressures: the error at the end falls with the tolerance.
TEST(Hydraulics, ErrorControlFollowsThePressures) {
  Rig rig;
  rig.opening = scene::RampMotion{0, .6, .05, .1, {}, 0};
  rig.damping = 2e3;
  const double t = .2;
  const Rig::Y exact = rig.fine(t, 100'000);
  std::printf("%10s %8s %14s %14s\n", "tolerance", "steps", "stroke [m]", "p_a / supply");
  double last = 0;
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    machines::Run run(rig.scene(), 1e-3, .8, {1e-12, 30});
    StepControlSettings settings;
    settings.tolerance = tolerance, settings.max_step = .02;
    const StepControl control(settings);
    for (const double end : {.05, .15, t}) {
      while (end - run.state.time > 1e-12) control.step(run.integrator, run.system, run.state, end);
      run.state.time = end;
    }
    const double stroke = std::abs(run.state.q[0] - exact[0]),
                 pressure = std::abs(run.state.z[0] - exact[2]) / 15e6;
    std::printf("%10.0e %8d %14.3e %14.3e\n", tolerance, static_cast<int>(run.integrator.counters().steps),
                stroke, pressure);
    EXPECT_LT(pressure, 300 * tolerance);
    if (last > 0) {
      EXPECT_LT(pressure, last / 5);
    }
    last = pressure;
  }
}

// What enters from the supply less what leaves is stored, done as work or dissipated.
TEST(Hydraulics, EnergyBalanceCloses) {
  Rig rig;
  rig.opening = scene::RampMotion{0, .6, 0, .2, {}, 0};
  rig.oil.leakage = 1e-11, rig.damping = 2e3;
  double last = 0;
  for (const double h : {2e-4, 1e-4, 5e-5}) {
    scene::Scene scene = rig.scene();
    scene.end_time = .2, scene.coupling.window = .02, scene.mbd->integrator.step = h;
    machines::WholeRun run(scene);
    const auto facts = run.facts();
    const double residual = std::abs(facts["mbd_energy_balance_J"].get<double>()),
                 work = facts["mbd_work_J"]["actuators"].get<double>();
    std::printf("h = %.0e s: work %.6f J, dissipated %.6f J, residual %.3e J, slope %s\n", h, work,
                facts["mbd_dissipated_J"].get<double>(), residual, slope_text(last, residual).c_str());
    EXPECT_LT(residual, 1e-3 * work);
    if (last > 0) {
      EXPECT_GT(std::log2(last / residual), 1.7);
    }
    last = residual;
  }
}

// A load that pulls faster than the pump feeds: the run says where the pressure is no pressure any more.
TEST(Hydraulics, CavitationIsMarked) {
  Rig rig;
  rig.load = 4e4, rig.opening = scene::ConstantMotion{1, 0};
  rig.oil.pump_flow = 1e-5, rig.oil.valve_flow = 1e-2;
  scene::Scene scene = rig.scene();
  scene.end_time = .02, scene.coupling.window = .01, scene.mbd->integrator.step = 1e-4;
  machines::WholeRun run(scene);
  const auto facts = run.facts();
  std::string all;
  for (const auto& warning : facts["warnings"]) all += warning.get<std::string>() + "\n";
  std::printf("%s", all.c_str());
  EXPECT_NE(all.find("cylinder \"jack\""), std::string::npos);
  EXPECT_NE(all.find("cavitat"), std::string::npos);
}

// An arm that two cylinders and a motor move.
scene::Scene driven_arm() {
  scene::Scene scene = machines::empty();
  const BodyId boom = machines::add_body(scene, "boom", 50, {1, 12, 12}, {1, 0, .5});
  const BodyId stick = machines::add_body(scene, "stick", 20, {.4, 3, 3}, {2.5, 0, .4});
  const BodyId tool = machines::add_body(scene, "tool", 5, {.1, .2, .2}, {3, 0, .1});
  machines::add_joint(scene, "foot", scene::JointType::revolute, ground, boom, {0, 0, .2}, {0, 1, 0});
  machines::add_joint(scene, "elbow", scene::JointType::revolute, boom, stick, {2, 0, .8}, {0, 1, 0});
  machines::add_joint(scene, "wrist", scene::JointType::revolute, stick, tool, {3, 0, .1}, {0, 1, 0});
  Rig rig;
  rig.oil.pressure_a = 8e6;
  scene::Cylinder c;
  c.name = "lift", c.body_b = boom, c.point_a = {.4, 0, -.3}, c.point_b = {1, 0, .4};
  c.control = scene::CylinderControl::valve, c.hydraulics = rig.oil,
  c.limits = scene::Limits{-.3, .3, 1e8, 1};
  c.target = scene::RampMotion{0, .3, 0, .3, {}, 0};
  scene.mbd->forces.push_back(c);
  c.name = "crowd", c.body_a = boom, c.body_b = stick, c.point_a = {1, 0, .9}, c.point_b = {2.3, 0, .9};
  c.control = scene::CylinderControl::stroke, c.hydraulics.reset(), c.limits.reset();
  c.gains = {2e5, 1e5, 2e4, .01, {}}, c.max_force = 2e4;
  scene.mbd->forces.push_back(c);
  scene::Motor m;
  m.name = "turn", m.joint = JointId{2}, m.target = scene::ConstantMotion{1, 0}, m.gains = {20, 50, 0, 0, {}};
  m.max_torque = 5, m.gear_ratio = 10, m.rotor_inertia = 1e-3;
  scene.mbd->forces.push_back(m);
  return scene;
}

// In any position and orientation of the world.
TEST(Hydraulics, AnArmMovesTheSameInAnyFrame) {
  const scene::Scene scene = driven_arm();
  const auto run = [](const scene::Scene& s) {
    machines::Run r(s, 1e-3, .8, {1e-12, 30});
    r.advance(300);
    return std::array<Vector3d, 3>{r.position(1), r.position(2), Vector3d(r.state.z[0], r.state.z[1], 0)};
  };
  const auto here = run(scene);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> any(-1, 1);
  double worst = 0, worst_pressure = 0;
  for (int i = 0; i < 20; ++i) {
    const Quat q = exp(Vec3d{3 * any(random), 3 * any(random), 3 * any(random)});
    const test::RigidMotion motion(q, {}, {10 * any(random), 10 * any(random), 10 * any(random)});
    const auto there = run(test::moved(scene, motion));
    for (int b = 0; b < 2; ++b) {
      const Vec3d back = motion.point_back({there[b].x(), there[b].y(), there[b].z()});
      worst = std::max(worst, (Vector3d(back.x, back.y, back.z) - here[b]).norm());
    }
    worst_pressure = std::max(worst_pressure, (there[2] - here[2]).norm());
  }
  std::printf("20 frames: positions differ by %.1e m (tolerance 1e-8), pressures by %.1e Pa (tolerance 1)\n",
              worst, worst_pressure);
  EXPECT_LT(worst, 1e-8);
  EXPECT_LT(worst_pressure, 1);
}

// The arm with a rope over a pulley, a brake, a sum of three angles and a force-controlled cylinder, in
// millimetres and tonnes and in other units.
TEST(Elements, AreTheSameInOtherUnits) {
  scene::Scene scene = driven_arm();
  const BodyId fan = machines::add_body(scene, "fan", 3, {.1, .2, .1}, {0, 1, 1});
  const BodyId crane = machines::add_body(scene, "crane", 8, {.4, .4, .4}, {2, 1, 1});
  machines::add_joint(scene, "axle", scene::JointType::revolute, ground, fan, {0, 1, 1}, {0, 1, 0});
  machines::add_joint(scene, "mast", scene::JointType::prismatic, ground, crane, {2, 1, 1}, {0, 0, 1});
  auto& motor = std::get<scene::Motor>(scene.mbd->forces.back());
  motor.brake = scene::Brake{.5, .1, {}, {}, ""};
  scene::Motor blower;
  blower.name = "blower", blower.joint = JointId{3}, blower.control = scene::MotorControl::throttle;
  blower.torque_speed = scene::ForceTable{{0, 50, 100}, {2, 1, 0}}, blower.gear_ratio = 4;
  blower.target = scene::ConstantMotion{.7, 0}, blower.rotor_inertia = 1e-3;
  scene.mbd->forces.push_back(blower);
  scene::Cylinder lift;
  lift.name = "jack", lift.body_b = crane, lift.point_a = {2.2, 1, -1}, lift.point_b = {2, 1, 1};
  lift.control = scene::CylinderControl::force, lift.target = scene::RampMotion{70, 110, 0, .2, {}, 0};
  lift.damping = 30, lift.friction = scene::Friction{4, .02, {}},
  lift.limits = scene::Limits{-.5, .01, 1e5, .2};
  scene.mbd->forces.push_back(lift);
  scene::Rope rope;
  rope.name = "rope", rope.points = {{ground, {3, 0, 3}}, {BodyId{1}, {2.5, 0, .4}}, {ground, {2, 0, 3}}};
  rope.length = 5.1, rope.axial_stiffness = 2e4, rope.damping = .05;
  scene.mbd->forces.push_back(rope);
  scene::Coupler sum;
  sum.name = "sum", sum.type = scene::CouplerType::linear;
  sum.terms = {{JointId{2}, {}, 1}, {JointId{3}, {}, -.3}, {JointId{4}, {}, 2}};
  scene.mbd->couplers.push_back(sum);
  struct Seen {
    std::array<Vector3d, 5> places;
    VectorXd states, coordinates;
  };
  const auto run = [](const scene::Scene& s) {
    machines::Run r(s, 1e-3, .8, {1e-12, 30});
    r.advance(300);
    Seen seen{{}, r.state.z.cwiseQuotient(r.model.state_scale), r.state.q};
    for (int b = 0; b < 5; ++b) seen.places[static_cast<std::size_t>(b)] = r.position(b);
    return seen;
  };
  const Seen here = run(scene);
  double moved = 0;
  for (int b = 0; b < 5; ++b) {
    const Vec3d p = scene.mbd->bodies[static_cast<std::size_t>(b)].pose.p_WB;
    moved = std::max(moved, (here.places[static_cast<std::size_t>(b)] - Vector3d(p.x, p.y, p.z)).norm());
  }
  EXPECT_GT(moved, .1);
  for (const auto& [length, mass] : {std::pair{1e3, 1e-3}, {1e-3, 1e-9}, {1e2, 1e6}, {1., 1e6}}) {
    const Seen there = run(test::in_units(scene, length, mass));
    double worst = 0;
    for (std::size_t b = 0; b < 5; ++b)
      worst = std::max(worst, (there.places[b] / length - here.places[b]).norm());
    const double states = (there.states - here.states).cwiseAbs().maxCoeff();
    std::printf(
        "units of 1/%g m and 1/%g kg: positions differ by %.1e m, states by %.1e of their scales "
        "(1e-8 allowed)\n",
        length, mass, worst, states);
    EXPECT_LT(worst, 1e-8);
    EXPECT_LT(states, 1e-8);
  }
}

}  // namespace hydraulics_test
}  // namespace tandem::mbd
