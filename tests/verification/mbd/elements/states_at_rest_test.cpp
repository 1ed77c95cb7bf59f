// Equilibria and modes of machines with states of first order: hydraulics and controllers, against closed
// forms.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <random>

#include "common/error.hpp"
#include "mbd_server/solve/equilibrium.hpp"
#include "mbd_server/solve/modes.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace states_at_rest_test {

using Roots = std::vector<std::complex<double>>;

void near(const std::string& what, double measured, double expected, double tolerance) {
  std::printf("%-56s expected %18.12g measured %18.12g tolerance %.0e\n", what.c_str(), expected, measured,
              tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

struct AtRest {
  machines::Run run;
  EquilibriumReport report;
  Modes modes;

  explicit AtRest(const scene::Scene& scene) : run(scene, 1e-3, .8, {1e-12, 30}) {
    run.restart([&](State& state) {
      state.u.setZero();
      report = find_equilibrium(run.model, run.system, state);
    });
    modes = find_modes(run.model, run.system, run.state);
  }
  // All roots but the zeros, ascending.
  Roots roots() const {
    Roots all;
    for (const Mode& mode : modes.modes) {
      all.push_back(mode.s);
      if (mode.s.imag() != 0) all.push_back(std::conj(mode.s));
    }
    return all;
  }
  // Largest distance that a body moves in a run from the equilibrium.
  double moves(int steps) {
    std::vector<Vector3d> begin;
    const int bodies = static_cast<int>(run.model.bodies.size());
    for (int b = 0; b < bodies; ++b) begin.push_back(run.position(b));
    run.advance(steps);
    double most = 0;
    for (int b = 0; b < bodies; ++b)
      most = std::max(most, (run.position(b) - begin[static_cast<std::size_t>(b)]).norm());
    return most;
  }
};

// Roots of sum of c[k] s^k.
Roots roots_of(std::vector<double> c) {
  const auto n = std::ssize(c) - 1;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.diagonal(-1).setOnes();
  for (Eigen::Index k = 0; k < n; ++k) companion(k, n - 1) = -c[static_cast<std::size_t>(k)] / c.back();
  const Eigen::VectorXcd all = companion.eigenvalues();
  return {all.begin(), all.end()};
}

// Every expected root has a measured one beside it, and there are no others.
void same_roots(const std::string& what, const Roots& measured, const Roots& expected, double tolerance) {
  ASSERT_EQ(measured.size(), expected.size()) << what;
  for (const std::complex<double>& s : expected) {
    const auto nearest = *std::min_element(measured.begin(), measured.end(),
                                           [&](auto a, auto b) { return std::abs(a - s) < std::abs(b - s); });
    std::printf("%-34s expected %14.8g %+14.8gi measured %14.8g %+14.8gi 1/s tolerance %.0e\n", what.c_str(),
                s.real(), s.imag(), nearest.real(), nearest.imag(), tolerance);
    EXPECT_LT(std::abs(nearest - s), tolerance * std::abs(s)) << what;
  }
}

void expect_refused(const scene::Scene& scene, const std::string& problem, const std::string& hint) {
  try {
    AtRest machine(scene);
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::scene);
    EXPECT_NE(error.problem().find(problem), std::string::npos) << error.problem();
    EXPECT_NE(error.hint().find(hint), std::string::npos) << error.hint();
  }
}

// A mass on a level rail and a cylinder of 1 m, with a load along the rail.
struct Jack {
  double mass = 200, load = -8e3, damping = 3e3, spring = 0, opening = 0;
  scene::HydraulicData oil;
  Jack() {
    oil.bore_area = 2e-3, oil.rod_area = 8e-4, oil.dead_volume = 1e-4;
    oil.supply_pressure = 15e6, oil.tank_pressure = 2e5;
    oil.valve_flow = 1e-3, oil.laminar_drop = 1e4;
    oil.pressure_a = 4e6, oil.pressure_b = 2e6;
  }
  double A() const { return oil.bore_area; }
  double B() const { return oil.bore_area - oil.rod_area; }
  double V_a(double s) const { return oil.dead_volume + A() * (s + .3); }
  double V_b(double s) const { return oil.dead_volume + B() * (.3 - s); }
  scene::Scene scene() const {
    scene::Scene s = machines::empty({0, 0, 0});
    const BodyId body = machines::add_body(s, "mass", mass, {1, 1, 1}, {1, 0, 0});
    machines::add_joint(s, "rail", scene::JointType::prismatic, ground, body, {1, 0, 0}, {1, 0, 0});
    scene::Cylinder c;
    c.name = "jack", c.body_b = body, c.point_b = {1, 0, 0};
    c.control = scene::CylinderControl::valve, c.hydraulics = oil, c.damping = damping;
    c.target = scene::ConstantMotion{opening, 0};
    c.limits = scene::Limits{-.3, .3, 1e9, 0};
    s.mbd->forces.push_back(c);
    s.mbd->forces.push_back(scene::Actuator{"load", JointId{0}, scene::ConstantMotion{load, 0}});
    if (spring > 0)
      s.mbd->forces.push_back(
          scene::SpringDamper{"spring", ground, body, {3, 0, 0}, {1, 0, 0}, spring, 0, 2});
    return s;
  }
};

// Where the force of the pressures of a stroke balances the load.
template <class Force>
double balance(const Force& force) {
  double low = -.3, high = .3;  // the force falls with the stroke
  for (int i = 0; i < 200; ++i) {
    const double s = (low + high) / 2;
    (force(s) > 0 ? low : high) = s;
  }
  return low;
}

// Behind a closed valve V e^(p/B) is constant in either chamber, and the oil is a spring.
TEST(OilAtRest, AClosedCylinderKeepsItsOil) {
  const Jack jack;
  const double K = jack.oil.bulk_modulus;
  const auto p_a = [&](double s) { return 4e6 - K * std::log(jack.V_a(s) / jack.V_a(0)); };
  const auto p_b = [&](double s) { return 2e6 - K * std::log(jack.V_b(s) / jack.V_b(0)); };
  const double s = balance([&](double at) { return jack.A() * p_a(at) - jack.B() * p_b(at) + jack.load; });
  AtRest machine(jack.scene());
  const State& state = machine.run.state;
  near("stroke [m]", state.q[0], s, 1e-12);
  near("pressure in chamber a [Pa]", state.z[0], p_a(s), 1e-2);
  near("pressure in chamber b [Pa]", state.z[1], p_b(s), 1e-2);
  EXPECT_EQ(machine.report.changed_state.substr(0, 8), "pressure");
  const double k = K * (std::pow(jack.A(), 2) / jack.V_a(s) + std::pow(jack.B(), 2) / jack.V_b(s));
  EXPECT_EQ(machine.modes.constants, 2) << "the oil of either chamber";
  EXPECT_EQ(machine.modes.neutral, 0);
  same_roots("mass on closed oil", machine.roots(), roots_of({k, jack.damping, jack.mass}), 1e-8);
  const double moved = machine.moves(2000);
  std::printf("moved %.1e m in 2 s (1e-10 allowed)\n", moved);
  EXPECT_LT(moved, 1e-10);
  // A motion from the pressures of the scene comes to rest at the same stroke.
  machines::Run run(jack.scene(), 2e-4, .8, {1e-12, 30});
  run.advance(10'000);
  near("stroke at which a motion comes to rest [m]", run.state.q[0], s, 1e-8);
}

// Leakage makes both pressures equal, p (A - B) = load; the masses of oil together give the stroke. One
// constant of the motion is left, and the roots are those of a cubic.
TEST(OilAtRest, LeakageLeavesOneConstant) {
  Jack jack;
  jack.oil.leakage = 2e-10, jack.load = -8e3;
  const double K = jack.oil.bulk_modulus, A = jack.A(), B = jack.B();
  const double oil = jack.V_a(0) * std::exp(4e6 / K) + jack.V_b(0) * std::exp(2e6 / K);
  const double p = -jack.load / (A - B), volume = oil * std::exp(-p / K);
  const double s = (volume - jack.V_a(0) - jack.V_b(0)) / (A - B);
  AtRest machine(jack.scene());
  const State& state = machine.run.state;
  near("stroke [m]", state.q[0], s, 1e-11);
  near("pressure in chamber a [Pa]", state.z[0], p, 1e-2);
  near("pressure in chamber b [Pa]", state.z[1], p, 1e-2);
  EXPECT_EQ(machine.modes.constants, 1);
  EXPECT_EQ(machine.modes.neutral, 0);
  const double a = K / jack.V_a(s), b = K / jack.V_b(s), l = jack.oil.leakage, m = jack.mass,
               c = jack.damping;
  same_roots("mass on oil with leakage", machine.roots(),
             roots_of({l * a * b * (A - B) * (A - B) / m, (a * A * A + b * B * B + c * l * (a + b)) / m,
                       c / m + l * (a + b), 1}),
             1e-8);
  EXPECT_LT(machine.moves(2000), 1e-9);
  // A motion exchanges equal volumes, not equal masses: the strokes agree to the compressibility p/B.
  machines::Run run(jack.scene(), 1e-2, .5, {1e-12, 30});
  run.advance(5000);
  near("stroke at which a motion comes to rest [m]", run.state.q[0], s, 0.01 * std::abs(s));
}

// An open valve gives the pressures of supply and tank whatever the stroke; a spring holds the mass.
TEST(OilAtRest, AnOpenValveGivesSupplyAndTank) {
  for (const double opening : {.02, -.02}) {
    Jack jack;
    jack.opening = opening, jack.spring = 5e5, jack.oil.laminar_drop = 1e6;
    const double p_a = opening > 0 ? 15e6 : 2e5, p_b = opening > 0 ? 2e5 : 15e6;
    AtRest machine(jack.scene());
    const State& state = machine.run.state;
    const double s = (jack.A() * p_a - jack.B() * p_b + jack.load) / jack.spring;
    near("stroke [m]", state.q[0], s, 1e-12);
    near("pressure in chamber a [Pa]", state.z[0], p_a, 1e-2);
    near("pressure in chamber b [Pa]", state.z[1], p_b, 1e-2);
    // Laminar edges about no flow: Q = G (p_port - p).
    const double drop = jack.oil.valve_drop, d = jack.oil.laminar_drop;
    const double G = std::abs(opening) * 1e-3 / drop * std::pow(drop * drop + d * d, .25) / std::sqrt(d);
    const double a = jack.oil.bulk_modulus / jack.V_a(s), b = jack.oil.bulk_modulus / jack.V_b(s);
    const double unit = 1e7;  // of pressures [Pa]
    Eigen::Matrix4d M;
    M << 0, 1, 0, 0, -jack.spring / jack.mass, -jack.damping / jack.mass, unit * jack.A() / jack.mass,
        -unit * jack.B() / jack.mass, 0, -a * jack.A() / unit, -a * G, 0, 0, b * jack.B() / unit, 0, -b * G;
    const Eigen::VectorXcd exact = M.eigenvalues();
    EXPECT_EQ(machine.modes.constants, 0);
    same_roots("mass on an open valve", machine.roots(), {exact.begin(), exact.end()}, 1e-8);
    EXPECT_LT(machine.moves(1000), 1e-9);
  }
}

// A rod of 1 m and 2 kg on a motor, from the horizontal.
scene::Scene arm(const scene::Motor& motor) {
  scene::Scene scene = machines::empty();
  const BodyId rod = machines::add_body(scene, "rod", 2, {0, 2. / 12, 2. / 12}, {.5, 0, 0});
  machines::add_joint(scene, "hinge", scene::JointType::revolute, ground, rod, {0, 0, 0}, {0, 1, 0});
  scene.mbd->forces.push_back(motor);
  return scene;
}
constexpr double arm_inertia = 2. / 3, arm_moment = 9.81;  // about the hinge [kg m2], [N m]

scene::Motor controller(scene::MotorControl control, double target, const scene::Gains& gains) {
  scene::Motor m;
  m.name = "motor", m.joint = JointId{0}, m.control = control;
  m.target = scene::ConstantMotion{target, 0};
  m.gains = gains;
  return m;
}

// I s^2 + k_p s + k_i = 0 in a steady rotation, where the integral bears the load.
TEST(ControlAtRest, SpeedControlHasItsQuadratic) {
  const double inertia = .4;
  for (const double kp : {.5, 2., 9.}) {
    scene::Scene scene = machines::empty({0, 0, 0});
    const BodyId wheel = machines::add_body(scene, "wheel", 1, {inertia, inertia, inertia}, {0, 0, 0});
    machines::add_joint(scene, "axle", scene::JointType::revolute, ground, wheel, {0, 0, 0}).rate = 5;
    scene.mbd->forces.push_back(controller(scene::MotorControl::speed, 5, {kp, 6, 0, 0, {}}));
    scene.mbd->forces.push_back(scene::Actuator{"load", JointId{0}, scene::ConstantMotion{-1.5, 0}});
    machines::Run run(scene, 1e-3);
    run.state.z[0] = 1.5 / 6;
    const Modes modes = find_modes(run.model, run.system, run.state);
    EXPECT_EQ(modes.constants, 1);
    EXPECT_EQ(modes.neutral, 0);
    Roots found;
    for (const Mode& mode : modes.modes) {
      found.push_back(mode.s);
      if (mode.s.imag() != 0) found.push_back(std::conj(mode.s));
    }
    same_roots("PI speed control", found, roots_of({6, kp, inertia}), 1e-10);
  }
}

// At the target 0 the integral of the speed is a spring about the angle of the start.
TEST(ControlAtRest, AnIntegralOfTheSpeedHolds) {
  AtRest machine(arm(controller(scene::MotorControl::speed, 0, {2, 30, 0, 0, {}})));
  // About +y the rod falls towards positive angles.
  double low = 0, high = 1;
  for (int i = 0; i < 100; ++i) {
    const double q = (low + high) / 2;
    (arm_moment * std::cos(q) > 30 * q ? low : high) = q;
  }
  near("angle [rad]", machine.run.state.q[0], low, 1e-12);
  near("integral [rad]", machine.run.state.z[0], -low, 1e-12);
  EXPECT_EQ(machine.modes.constants, 1);
  EXPECT_EQ(machine.modes.neutral, 0);
  same_roots("arm on PI speed control", machine.roots(),
             roots_of({30 + arm_moment * std::sin(low), 2, arm_inertia}), 1e-9);
  EXPECT_LT(machine.moves(5000), 1e-9);
}

// PID control with a filtered derivative: no error is left, and the integral bears the weight.
TEST(ControlAtRest, PositionControlReachesItsTarget) {
  for (const double target : {.3, -2.5}) {
    const double kp = 80, ki = 40, kd = 8, tau = .02;
    AtRest machine(arm(controller(scene::MotorControl::position, target, {kp, ki, kd, tau, {}})));
    near("angle [rad]", machine.run.state.q[0], target, 1e-10);
    near("torque of the integral [N m]", ki * machine.run.state.z[0], -arm_moment * std::cos(target), 1e-8);
    const double k = arm_moment * std::sin(target), I = arm_inertia;
    same_roots("arm on PID control", machine.roots(),
               roots_of({ki, kp + k + ki * tau, kd + (kp + k) * tau, I, I * tau}), 1e-8);
    EXPECT_LT(machine.moves(3000), 1e-8);
    std::printf("found in %d iterations\n", machine.report.iterations);
  }
}

// Without proportional gain the first force is zero, and a weak integral has to grow.
TEST(ControlAtRest, AnIntegralAloneReachesItsTarget) {
  for (const double ki : {1e-6, 1., 1e6}) {
    AtRest machine(arm(controller(scene::MotorControl::position, .4, {0, ki, 0, 0, 1.})));
    near("angle [rad]", machine.run.state.q[0], .4, 1e-10);
    near("torque of the integral [N m]", ki * machine.run.state.z[0], -arm_moment * std::cos(.4), 1e-8);
    std::printf("integral gain %.0e: found in %d iterations\n", ki, machine.report.iterations);
  }
}

// A motor that cannot bear the arm gives what it can: cos q = limit / moment.
TEST(ControlAtRest, ALimitedMotorGivesItsLimit) {
  for (const scene::MotorControl control : {scene::MotorControl::position, scene::MotorControl::speed}) {
    scene::Motor m =
        controller(control, control == scene::MotorControl::speed ? -.2 : 0, {80, 400, 0, 0, {}});
    m.max_torque = 1, m.gear_ratio = 5;
    AtRest machine(arm(m));
    near("angle [rad]", machine.run.state.q[0], std::acos(5 / arm_moment), 1e-10);
    EXPECT_EQ(machine.modes.constants, 0);
    EXPECT_LT(machine.moves(5000), 1e-8);
  }
}

TEST(ControlAtRest, IntegralsThatGrowWithoutEndAreRefused) {
  expect_refused(
      arm(controller(scene::MotorControl::speed, 5, {2, 6, 0, 0, {}})),
      "the integral of motor \"motor\" grows without end in an equilibrium: its target at the start "
      "is 5 rad/s",
      "limit the torque");
  // The points of the cylinder are 2 m apart at most, and the target asks for 3 m.
  scene::Scene scene = arm(controller(scene::MotorControl::position, 1, {2, 6, 0, 0, {}}));
  scene.mbd->forces.clear();
  scene::Cylinder c;
  c.name = "jack", c.point_a = {0, 0, 1}, c.body_b = BodyId{0}, c.point_b = {1, 0, 0};
  c.control = scene::CylinderControl::stroke, c.gains = {1e3, 1e3, 0, 0, {}};
  c.target = scene::ConstantMotion{3 - std::sqrt(2.), 0};
  scene.mbd->forces.push_back(c);
  expect_refused(scene, "the integral of cylinder \"jack\" grows without end",
                 "give a target that it can reach");
}

TEST(ControlAtRest, ModesWantStatesThatRest) {
  machines::Run run(arm(controller(scene::MotorControl::position, 0, {80, 40, 0, 0, {}})), 1e-3);
  run.state.z[0] = -arm_moment / 40;
  EXPECT_EQ(find_modes(run.model, run.system, run.state).neutral, 0);
  machines::Run wheel(arm(controller(scene::MotorControl::position, 1e-3, {80, 40, 0, 0, {}})), 1e-3);
  wheel.state.z[0] = -(arm_moment + .08) / 40;
  try {
    find_modes(wheel.model, wheel.system, wheel.state);
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_NE(error.problem().find("the integral of motor \"motor\" changes by 0.001 of its scale per s"),
              std::string::npos)
        << error.problem();
  }
}

// An arm of three bodies that two cylinders and a motor hold, with a loop, in any frame.
TEST(StatesAtRest, AreTheSameInAnyFrame) {
  scene::Scene scene = machines::empty();
  const BodyId boom = machines::add_body(scene, "boom", 50, {1, 12, 12}, {1, 0, .5});
  const BodyId stick = machines::add_body(scene, "stick", 20, {.4, 3, 3}, {2.5, 0, .4});
  const BodyId tool = machines::add_body(scene, "tool", 5, {.1, .2, .2}, {3, 0, .1});
  machines::add_joint(scene, "foot", scene::JointType::revolute, ground, boom, {0, 0, .2}, {0, 1, 0});
  machines::add_joint(scene, "elbow", scene::JointType::revolute, boom, stick, {2, 0, .8}, {0, 1, 0});
  machines::add_joint(scene, "wrist", scene::JointType::revolute, stick, tool, {3, 0, .1}, {0, 1, 0});
  const Jack jack;
  scene::Cylinder c;
  c.name = "lift", c.body_b = boom, c.point_a = {.4, 0, -.3}, c.point_b = {1, 0, .4};
  c.control = scene::CylinderControl::valve, c.hydraulics = jack.oil;
  c.limits = scene::Limits{-.3, .3, 1e8, 1};
  scene.mbd->forces.push_back(c);
  c.name = "crowd", c.body_a = boom, c.body_b = stick, c.point_a = {1, 0, .9}, c.point_b = {2.3, 0, .9};
  c.control = scene::CylinderControl::stroke, c.hydraulics.reset(), c.limits.reset();
  c.target = scene::ConstantMotion{.05, 0};
  c.gains = {2e5, 1e5, 2e4, .01, {}}, c.max_force = 2e4;
  scene.mbd->forces.push_back(c);
  scene::Motor m = controller(scene::MotorControl::speed, 0, {20, 50, 0, 0, {}});
  m.joint = JointId{2}, m.max_torque = 5, m.gear_ratio = 10, m.rotor_inertia = 1e-3;
  scene.mbd->forces.push_back(m);
  AtRest here(scene);
  EXPECT_NEAR(here.run.system.links()[1].V.norm(), 0, 1e-12);
  const Roots roots = here.roots();
  ASSERT_EQ(roots.size(), 8U) << "of 6 + 5 states, less two of closed oil and one of the integral";
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  double worst = 0, worst_root = 0, worst_state = 0;
  for (int i = 0; i < 10; ++i) {
    const test::RigidMotion motion(test::random_rotation(random), {},
                                   {10 * any(random), 10 * any(random), 10 * any(random)});
    AtRest there(test::moved(scene, motion));
    ASSERT_EQ(there.roots().size(), roots.size());
    for (int b = 0; b < 3; ++b) {
      const Vector3d p = there.run.position(b);
      const Vec3d back = motion.point_back({p.x(), p.y(), p.z()});
      worst = std::max(worst, (Vector3d(back.x, back.y, back.z) - here.run.position(b)).norm());
    }
    for (std::size_t k = 0; k < roots.size(); ++k)
      worst_root = std::max(worst_root, std::abs(there.roots()[k] - roots[k]) / std::abs(roots[k]));
    worst_state = std::max(worst_state, there.run.system.state_norm(there.run.state.z - here.run.state.z));
  }
  std::printf(
      "10 frames: positions differ by %.1e m (1e-9 allowed), roots by %.1e (1e-7 allowed), states by "
      "%.1e of their scales (1e-9 allowed)\n",
      worst, worst_root, worst_state);
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT(worst_root, 1e-7);
  EXPECT_LT(worst_state, 1e-9);
}

}  // namespace states_at_rest_test
}  // namespace tandem::mbd
