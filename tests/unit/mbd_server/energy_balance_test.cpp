// Energy balance of the multibody part: work and dissipation of each element against closed forms, the order
// of its residual, and equal figures after a restart.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "mbd_server/coupling/mbd_solver.hpp"
#include "mbd_server/forces/joint_force.hpp"
#include "tests/unit/mbd_server/workshop.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using Json = nlohmann::json;
using machines::bead;
using scene::JointType;
constexpr double pi = std::numbers::pi;

// Windows of 10 ms.
void advance(MbdSolver& solver, int first, int last) {
  for (int n = first; n < last; ++n) {
    protocol::LoadSet loads;
    loads.window = {static_cast<std::uint64_t>(n), {n * 10'000'000ll}, {(n + 1) * 10'000'000ll}};
    solver.advance(loads);
  }
}

Json facts(MbdSolver& solver) {
  return Json::parse(solver.report().facts);
}

Json run(scene::Scene scene, double seconds, double step) {
  scene.mbd->integrator.step = step;
  MbdSolver solver;
  solver.configure(scene);
  advance(solver, 0, static_cast<int>(std::lround(100 * seconds)));
  return facts(solver);
}

double number(const Json& facts, const char* key) {
  return facts[key].get<double>();
}
double work(const Json& facts, const char* of) {
  return facts["mbd_work_J"][of].get<double>();
}

// A wheel of 0.4 kg m2.
scene::Scene wheel() {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId body = machines::add_body(scene, "wheel", 1, {.4, .4, .4}, {0, 0, 0});
  machines::add_joint(scene, "axle", JointType::revolute, ground, body, {0, 0, 0});
  return scene;
}

struct Oscillator {
  double m = 2, c = 3, k = 500, x0 = .1;
  double lambda = c / (2 * m), w = std::sqrt(k / m - lambda * lambda);
  // Remaining energy of a motion that starts at rest at x0.
  double energy(double t) const {
    const double decay = x0 * std::exp(-lambda * t);
    const double x = decay * (std::cos(w * t) + lambda / w * std::sin(w * t));
    const double v = -decay * (w + lambda * lambda / w) * std::sin(w * t);
    return .5 * m * v * v + .5 * k * x * x;
  }
};

// In a damper between points, and in the damper of a joint.
TEST(EnergyBalance, DampersDissipateAsTheOscillatorDecays) {
  const Oscillator o;
  const double exact = o.energy(0) - o.energy(1);
  for (const bool in_joint : {false, true}) {
    scene::Scene scene = bead(o.m, 0);
    scene.mbd->joints[0].damping = in_joint ? o.c : 0;
    scene.mbd->forces.push_back(scene::SpringDamper{
        "s", ground, BodyId{0}, {-1, 0, 0}, {0, 0, 0}, o.k, in_joint ? 0 : o.c, 1 - o.x0});
    double last = 0;
    for (const double h : {2e-3, 1e-3}) {
      const Json f = run(scene, 1, h);
      const double error = std::abs(number(f, "mbd_dissipated_J") - exact);
      std::printf("oscillator, h = %.0e s: dissipated %.9f J, error %.1e; residual %.1e J\n", h,
                  number(f, "mbd_dissipated_J"), error, number(f, "mbd_energy_balance_J"));
      EXPECT_LT(error, 1e-3 * exact);
      EXPECT_LT(std::abs(number(f, "mbd_energy_balance_J")), 5e-4 * exact);
      EXPECT_EQ(f["mbd_energy_drift_J"], f["mbd_energy_balance_J"]);
      if (last > 0) {
        EXPECT_NEAR(std::log2(last / error), 2, .2);
      }
      last = error;
    }
  }
}

TEST(EnergyBalance, MotorsDoTorqueTimesAngle) {
  scene::Scene scene = wheel();
  scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, scene::ConstantMotion{3, 0}});
  const double constant = 3 * 3 / (2 * .4);  // T^2 t^2 / 2 I after 1 s
  Json f = run(scene, 1, 1e-2);
  EXPECT_NEAR(work(f, "actuators"), constant, 1e-12);
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), 0, 1e-12);

  const double T = 3, w = 6;
  scene.mbd->forces[0] = scene::Actuator{"motor", JointId{0}, scene::HarmonicMotion{0, T, w / (2 * pi), 0}};
  const double rate = T / (.4 * w) * (1 - std::cos(w));
  f = run(scene, 1, 1e-3);
  EXPECT_NEAR(work(f, "actuators"), .5 * .4 * rate * rate, 1e-4);
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), 0, 1e-5);
}

TEST(EnergyBalance, ControlInputsAreActuators) {
  scene::Scene scene = wheel();
  scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, scene::ConstantMotion{}, "drive"});
  scene.mbd->integrator.step = 1e-3;
  MbdSolver solver;
  solver.configure(scene);
  double rate = 0;
  for (int n = 0; n < 50; ++n) {
    const double torque = std::sin(n);
    solver.control({{n * 10'000'000ll}, {torque}});
    advance(solver, n, n + 1);
    rate += .01 * torque / .4;
  }
  const Json f = facts(solver);
  EXPECT_NEAR(work(f, "actuators"), .5 * .4 * rate * rate, 1e-12);
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), 0, 1e-12);
}

// x = A sin(w t) drives a bead against a damper, a spring and friction of its own joint: the work of the
// motion is the energy that these and the bead receive.
TEST(EnergyBalance, MotionsBringWhatTheDrivenBodyTakes) {
  const double m = 2, A = .1, w = 2 * pi * 3, c = 40, t = .56;
  scene::Scene scene = bead(m, 0);
  scene.mbd->joints[0].motion = scene::HarmonicMotion{0, A, 3, 0};
  scene.mbd->joints[0].damping = c;
  scene.mbd->forces.push_back(scene::SpringDamper{"s", ground, BodyId{0}, {-1, 0, 0}, {0, 0, 0}, 300, 0, 1});
  const double lost = c * A * A * w * w * (t / 2 + std::sin(2 * w * t) / (4 * w));
  const double x = A * std::sin(w * t), v0 = A * w, v = v0 * std::cos(w * t);
  const double given = .5 * m * (v * v - v0 * v0) + .5 * 300 * x * x + lost;
  const Json f = run(scene, t, 1e-3);
  EXPECT_NEAR(number(f, "mbd_dissipated_J"), lost, 1e-6 * lost);
  EXPECT_NEAR(work(f, "motions"), given, 1e-4 * given);
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), 0, 1e-4 * given);
}

// A motion that drives through a coupler: the multiplier is part of its effort.
TEST(EnergyBalance, MotionsDriveThroughGears) {
  scene::Scene scene = wheel();
  const BodyId second = machines::add_body(scene, "second", 1, {.2, .2, .2}, {1, 0, 0});
  machines::add_joint(scene, "axle2", JointType::revolute, ground, second, {1, 0, 0});
  scene.mbd->joints[0].motion = scene::RampMotion{0, 1, .1, .3};
  scene.mbd->joints[0].damping = .5;
  scene.mbd->couplers.push_back({"gear", scene::CouplerType::gear, JointId{0}, JointId{1}, -2});
  const double reduced = .4 + 4 * .2, rate = 1 / .3 * 30. / 16;  // at half the ramp
  const Json f = run(scene, .25, 1e-3);
  EXPECT_NEAR(work(f, "motions"), .5 * reduced * rate * rate + number(f, "mbd_dissipated_J"), 5e-4);
  EXPECT_GT(number(f, "mbd_dissipated_J"), .1);
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), 0, 5e-4);
}

TEST(EnergyBalance, FrictionTakesForceTimesWay) {
  scene::Scene scene = bead(2, 1.5);
  scene.mbd->joints[0].friction = scene::Friction{4, 1e-3};
  const double t = .5, way = 1.5 * t - t * t;  // a = -F / m = -2 m/s2
  const Json f = run(scene, t, 1e-3);
  EXPECT_NEAR(number(f, "mbd_dissipated_J"), 4 * way, 1e-9);
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), 0, 1e-9);
}

// A force that rotates with its body at w: its velocity is F/(m w) (sin w t, 1 - cos w t).
TEST(EnergyBalance, LoadsThatFollowDoWorkAlongTheirTurningDirection) {
  const double F = 3, m = 2, w = 5;
  scene::Scene scene = machines::free_body(m, {.1, .1, .1}, {0, 0, 0});
  scene.mbd->bodies[0].twist.w_WB = {0, 0, w};
  scene.mbd->forces.push_back(scene::BodyLoad{"jet",
                                              scene::BodyLoad::Kind::force,
                                              BodyId{0},
                                              {0, 0, 0},
                                              {1, 0, 0},
                                              true,
                                              scene::ConstantMotion{F, 0}});
  const double exact = F * F / (m * w * w) * (1 - std::cos(w * .5));
  const Json f = run(scene, .5, 1e-3);
  EXPECT_NEAR(work(f, "loads"), exact, 1e-5 * exact);
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), 0, 1e-5 * exact);
}

// A torque about the free axis of a body that spins about another axis: the body does not rotate about the
// torque's direction alone, so that the rotation of a step is not a sum of angles.
TEST(EnergyBalance, TorquesOnATumblingBodyDoWhatItGains) {
  double last = 0;
  for (const double h : {2e-3, 1e-3}) {
    scene::Scene scene = machines::free_body(2, {.1, .2, .3}, {0, 0, 0});
    scene.mbd->bodies[0].twist.w_WB = {1, 6, 0};
    for (const bool follows : {false, true})
      scene.mbd->forces.push_back(scene::BodyLoad{"t",
                                                  scene::BodyLoad::Kind::torque,
                                                  BodyId{0},
                                                  {},
                                                  {0, .6, .8},
                                                  follows,
                                                  scene::HarmonicMotion{1, 1, 2, 0}});
    const Json f = run(scene, .5, h);
    const double residual = std::abs(number(f, "mbd_energy_balance_J"));
    std::printf("tumbling body, h = %.0e s: work %.6f J, residual %.1e J\n", h, work(f, "loads"), residual);
    EXPECT_LT(residual, 1e-3 * work(f, "loads"));
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / residual), 2, .2);
    }
    last = residual;
  }
}

// A bushing with damping only: the velocity decays with c/m, the spin about one axis with d/I.
TEST(EnergyBalance, BushingsDissipateWhatABodyLoses) {
  scene::Scene scene = machines::free_body(2, {.1, .1, .1}, {0, 0, 0});
  scene.mbd->bodies[0].twist = {{1, -2, .5}, {0, 0, 1}};
  scene::Bushing bushing{"mount", ground, BodyId{0}, {0, 0, 0}, {}, {}};
  for (int i = 0; i < 6; ++i) bushing.damping[static_cast<std::size_t>(7 * i)] = i < 3 ? 4 : .3;
  scene.mbd->forces.push_back(bushing);
  const double start = .5 * 2 * 5.25 + .5 * .1;
  const double end = .5 * 2 * 5.25 * std::exp(-4 * .5) + .5 * .1 * std::exp(-6 * .5);
  const Json f = run(scene, .5, 1e-3);
  EXPECT_NEAR(number(f, "mbd_dissipated_J"), start - end, 1e-5);
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), 0, 1e-5);
}

// A ball on a damped socket: w decays with c/I about any axis.
TEST(EnergyBalance, SocketsDissipateAboutAllAxes) {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId ball = machines::add_body(scene, "ball", 1, {.1, .1, .1}, {0, 0, 0});
  machines::add_joint(scene, "socket", JointType::spherical, ground, ball, {0, 0, 0}).damping = .3;
  scene.mbd->forces.push_back(scene::BodyLoad{
      "t", scene::BodyLoad::Kind::torque, BodyId{0}, {}, {.6, 0, .8}, false, scene::ConstantMotion{1, 0}});
  // w = T/c (1 - e^-at), a = c/I
  const double a = 3, t = .5, e = std::exp(-a * t);
  const double lost = 1 / .3 * (t - 2 * (1 - e) / a + (1 - e * e) / (2 * a));
  const Json f = run(scene, t, 1e-3);
  EXPECT_NEAR(number(f, "mbd_dissipated_J"), lost, 1e-5);
  EXPECT_NEAR(work(f, "loads"), lost + .5 * .1 * std::pow(1 / .3 * (1 - e), 2), 1e-5);
}

TEST(EnergyBalance, StopsDissipateWhatTheReboundLacks) {
  scene::Scene scene = bead(2, 1);
  scene.mbd->joints[0].limits = scene::Limits{-.1, .1, 1e5, .5};
  scene.mbd->integrator.error_tolerance = 1e-10;
  MbdSolver solver;
  solver.configure(scene);
  advance(solver, 0, 40);
  const double v = solver.state().u[0];
  EXPECT_LT(std::abs(v), .9);
  const Json f = facts(solver);
  EXPECT_NEAR(number(f, "mbd_dissipated_J"), .5 * 2 * (1 - v * v), 1e-4);
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), 0, 1e-4);
}

// Without a load, and with a weight that is small relative to the contact force: 0.1 m of fall, then rebounds
// to e^2 of it.
TEST(EnergyBalance, RestitutionTakesWhatTheReboundLacks) {
  for (const double g : {0., 9.81}) {
    scene::Scene scene = bead(2, g == 0 ? 1 : 0);
    scene.gravity = {g, 0, 0};
    scene.mbd->joints[0].limits = scene::Limits{-.1, .1, 1e7, 0, .5};
    const double entry = g == 0 ? 1 : std::sqrt(2 * g * .1);
    const Json f = run(scene, g == 0 ? .15 : .2, 1e-3);
    EXPECT_NEAR(number(f, "mbd_dissipated_J"), .5 * 2 * entry * entry * (1 - .25), 2e-3 * entry * entry);
    EXPECT_NEAR(number(f, "mbd_largest_energy_balance_J"), 0, 2e-3 * entry * entry);
  }
}

// The work of forces on a joint that is not stored is dissipated, in any state.
TEST(EnergyBalance, PowerOfJointForcesIsStoredOrLost) {
  const Model model = build_model(bead(1, 0));
  const State state = initial_state(model, bead(1, 0));
  JointForce force;
  force.link = 1;
  force.rest = .3;
  force.elastic = ForceLaw(0, scene::ForceTable{{-1, 0, .5, 1}, {-30, 0, 20, 60}});
  force.viscous = ForceLaw(0, scene::ForceTable{{-2, 0, 3}, {-5, 0, 20}});
  force.friction = scene::Friction{2, .1};
  force.limits = scene::Limits{-.2, .4, 1e3, .7};
  EXPECT_TRUE(dissipates(force));
  for (const double q : {-.7, -.1, .3, .6})
    for (const double u : {-4., -.3, .05, 2.}) {
      const double rate_of_energy = (energy(force, q + 1e-6 * u) - energy(force, q - 1e-6 * u)) / 2e-6;
      const double power = evaluate(force, model, state, q, u).force * u;
      EXPECT_NEAR(power, -rate_of_energy - dissipated_power(force, state.stops, 1, q, u),
                  1e-5 * (1 + std::abs(power)));
      EXPECT_GE(dissipated_power(force, state.stops, 1, q, u), 0);
    }
}

// Joints and forces of all kinds: the residual is of second order, in the tree and with loops.
TEST(EnergyBalance, ResidualFallsWithTheSquareOfTheStep) {
  for (const bool loops : {false, true}) {
    scene::Scene scene = loops ? workshop() : machines::menagerie();
    if (loops) scene.mbd->joints[5].limits.reset();  // the first contact has no order
    double last = 0;
    for (const double h : {2e-3, 1e-3, 5e-4}) {
      const Json f = run(scene, .4, h);
      const double residual = std::abs(number(f, "mbd_energy_balance_J"));
      std::printf("%s, h = %.0e s: residual %.2e J of %.3g J\n", loops ? "workshop" : "menagerie", h,
                  residual, number(f, "mbd_energy_scale_J"));
      EXPECT_LT(residual, 100 * h * h * number(f, "mbd_energy_scale_J"));
      if (last > 0) {
        EXPECT_NEAR(std::log2(last / residual), 2, .3);
      }
      last = residual;
    }
  }
}

// The impulse of a motion whose rate jumps is work of the motion.
TEST(EnergyBalance, MotionsThatJumpDoWorkByTheirImpulse) {
  scene::Scene scene = bead(2, 0);
  scene.mbd->joints[0].motion = scene::TableMotion{{.1, .2, .3}, {0, .3, 0}, scene::Interpolation::spline};
  const Json f = run(scene, .25, 1e-3);
  EXPECT_GT(work(f, "motions"), 0);
  EXPECT_NEAR(number(f, "mbd_largest_energy_balance_J"), 0, 1e-6 * number(f, "mbd_energy_scale_J"));
}

// One radian per step: numerical damping is neither work nor dissipation of the machine.
TEST(EnergyBalance, ShowsWhatTheMethodLoses) {
  scene::Scene scene = bead(1, 0);
  scene.mbd->integrator.rho_inf = .5;
  scene.mbd->forces.push_back(scene::SpringDamper{"s", ground, BodyId{0}, {-1, 0, 0}, {0, 0, 0}, 1e4, 0, .9});
  const Json f = run(scene, 1, 1e-2);
  const double start = .5 * 1e4 * .01;
  EXPECT_NEAR(number(f, "mbd_energy_balance_J"), -start, .2 * start);
  EXPECT_EQ(number(f, "mbd_dissipated_J"), 0);
  EXPECT_GT(std::abs(number(f, "mbd_largest_energy_balance_J")), .5 * number(f, "mbd_energy_scale_J"));
  EXPECT_GT(number(f, "mbd_largest_energy_balance_at_s"), 0);
}

TEST(EnergyBalance, ScaleIsTheEnergyInMotionOrThatChangedHands) {
  // A wheel at 2 rad/s without a drive; then one with a motor and a brake.
  scene::Scene scene = wheel();
  scene.mbd->joints[0].rate = 2;
  EXPECT_NEAR(number(run(scene, .1, 1e-3), "mbd_energy_scale_J"), .5 * .4 * 4, 1e-12);
  scene.mbd->joints[0].damping = 5;
  scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, scene::ConstantMotion{10, 0}});
  EXPECT_NEAR(number(run(scene, 1, 1e-3), "mbd_energy_scale_J"), 2 * 10 * 2, 1e-9);
  // At rest: far below the energy of any motion, and not zero.
  const double rest = number(run(machines::ladder(1), 0, 1e-3), "mbd_energy_scale_J");
  EXPECT_GT(rest, 0);
}

// ---- figures of reactions, freedoms and constraints

TEST(RunFigures, NameTheLargestReactionAndItsScale) {
  scene::Scene scene = machines::pendulum();
  MbdSolver solver;
  scene.mbd->integrator.step = 1e-3;
  solver.configure(scene);
  for (int n = 0; n < 90; ++n) {
    advance(solver, n, n + 1);
    solver.observe();
  }
  const Json f = facts(solver);
  // From the horizontal: 3 m g at the bottom; the scale is the weight and the inertia force of 2 m g.
  EXPECT_NEAR(number(f, "mbd_largest_reaction_N"), 3 * 9.81, .02);
  EXPECT_EQ(f["mbd_largest_reaction_joint"], "pin");
  EXPECT_NEAR(number(f, "mbd_reaction_scale_N"), 3 * 9.81, .02);
}

TEST(RunFigures, ScaleOfForcesHasLoadsSpringsAndTorquesByTheSize) {
  scene::Scene scene = wheel();
  scene.mbd->bodies[0].pose.p_WB = {2, 0, 0};  // the machine is 2 m long
  auto& forces = scene.mbd->forces;
  forces.push_back(scene::Actuator{"motor", JointId{0}, scene::ConstantMotion{6, 0}});
  forces.push_back(scene::BodyLoad{"push",
                                   scene::BodyLoad::Kind::force,
                                   BodyId{0},
                                   {2, 0, 0},
                                   {1, 0, 0},
                                   false,
                                   scene::ConstantMotion{-5, 0}});
  forces.push_back(scene::BodyLoad{
      "twist", scene::BodyLoad::Kind::torque, BodyId{0}, {}, {0, 0, 1}, false, scene::ConstantMotion{-6, 0}});
  machines::Run at_rest(scene, 1e-3);
  at_rest.system.residual(at_rest.state);
  EXPECT_NEAR(force_scale(at_rest.model, at_rest.state, at_rest.system.links()), 5 + 6. / 2 + 6. / 2, 1e-9);
}

TEST(RunFigures, CountFreedomsAndTheWorstConstraint) {
  const Json f = run(machines::ladder(2), 1, 1e-3);
  EXPECT_EQ(f["mbd_dof_end"], 1);
  EXPECT_EQ(f["mbd_dof_lowest"], 1);
  EXPECT_GE(number(f, "mbd_largest_constraint_violation"), number(f, "constraint_violation"));
  EXPECT_LT(number(f, "mbd_largest_constraint_violation"), 1e-12);
}

// ---- restarts

const std::vector<std::string> carried{"mbd_work_J",
                                       "mbd_dissipated_J",
                                       "mbd_load_work_J",
                                       "mbd_energy_balance_J",
                                       "mbd_energy_scale_J",
                                       "mbd_largest_energy_balance_J",
                                       "mbd_largest_energy_balance_at_s",
                                       "mbd_dof_lowest",
                                       "mbd_largest_reaction_N",
                                       "mbd_largest_reaction_joint",
                                       "mbd_reaction_scale_N",
                                       "mbd_largest_constraint_violation"};

TEST(RunFigures, AreTheSameAfterARestartAndAfterWindowsTakenBack) {
  MbdSolver straight;
  straight.configure(workshop());
  advance(straight, 0, 20);
  straight.observe();
  advance(straight, 20, 40);
  const Json expected = facts(straight);
  EXPECT_NE(work(expected, "actuators"), 0);
  EXPECT_NE(work(expected, "loads"), 0);
  EXPECT_GT(number(expected, "mbd_dissipated_J"), 0);

  const std::string path =
      std::filesystem::temp_directory_path() / ("balance_" + std::to_string(getpid()) + ".h5");
  MbdSolver first;
  first.configure(workshop());
  advance(first, 0, 15);
  first.save();
  advance(first, 15, 19);
  first.restore();
  advance(first, 15, 20);
  first.observe();
  first.checkpoint({20, {200'000'000}, path});
  MbdSolver second;
  second.configure(workshop());
  second.resume({20, {200'000'000}, path});
  advance(second, 20, 40);
  const Json resumed = facts(second);
  for (const std::string& key : carried) EXPECT_EQ(resumed[key], expected[key]) << key;
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tandem::mbd
