// The explicit method: fifth order on trees of all kinds, with exact values where there are some, the error
// over processor time beside the implicit method, and the energy under error control.
#include <gtest/gtest.h>

#include <cmath>

#include "common/cpu_time.hpp"
#include "mbd_server/step/dormand_prince.hpp"
#include "mbd_server/step/step_control.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace explicit_method_test {

struct Explicit : machines::Run {
  DormandPrince method;

  Explicit(const scene::Scene& machine, double h, const std::function<void(State&)>& begin = {})
      : Run(machine, h), method(system, state) {
    if (begin) begin(state);
    method.start(system, state, h);
  }
  void advance(int steps) {
    for (int i = 0; i < steps; ++i) method.step(system, state, step);
  }
  // Returns the processor time [s].
  double control(double end, double tolerance) {
    const StepControl control({.tolerance = tolerance, .max_step = end});
    const double begin = cpu_seconds(CpuClock::thread);
    while (end - state.time > 1e-12) control.step(method, system, state, end);
    return cpu_seconds(CpuClock::thread) - begin;
  }
};

// A01 at t = 10 s, closed form.
const Vector3d pendulum_end(-0.275087462576117, -0.961419205099125, 0);

TEST(ExplicitMethod, FifthOrderOnThePendulum) {
  OrderTable table("A01 by Dormand-Prince, t = 10 s", {"position [m]", "energy [J]"});
  for (int steps = 400; steps <= 1600; steps *= 2) {
    Explicit run(machines::pendulum(), 10. / steps);
    const double energy = run.energy();
    run.advance(steps);
    table.add(10. / steps, {(run.position(0) - pendulum_end).norm(), std::abs(run.energy() - energy)});
  }
  table.expect_order(5, .5);
}

// A spherical joint in the tree, turning by 150 rad/s about its own axis.
TEST(ExplicitMethod, FifthOrderOnTheHeavyTop) {
  const Vector3d exact(0.6055505613772, 0.5989576817948, -0.5239830274301);
  OrderTable table("heavy top by Dormand-Prince, t = 0.2 s", {"position [m]"});
  for (int steps = 200; steps <= 800; steps *= 2) {
    Explicit run(machines::heavy_top(), .2 / steps,
                 [](State& state) { state.u = Vector3d(0, 150, -4.61538); });
    run.advance(steps);
    EXPECT_NEAR(run.state.q.norm(), 1, 1e-14);
    table.add(.2 / steps, {(run.position(0) - exact).norm()});
  }
  table.expect_order(5, .3);
}

double difference(const machines::Run& a, const machines::Run& b) {
  VectorXd x = VectorXd::Zero(a.state.u.size());
  a.system.difference(a.state.q, b.state.q, x);
  return x.norm();
}

// Ten rods on revolute joints about all three axes.
scene::Scene spatial_chain() {
  scene::Scene scene = machines::chain(10);
  const Vec3d axes[] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  for (std::size_t i = 0; i < scene.mbd->joints.size(); ++i) {
    scene.mbd->joints[i].axis = axes[i % 3];
    scene.mbd->joints[i].rate = i % 2 == 0 ? 1 : -2;
    scene.mbd->bodies[i].inertia = {1e-4, 2e-4, 2.5e-4, 0, 0, 0};
  }
  return scene;
}

TEST(ExplicitMethod, FifthOrderOnASpatialChain) {
  Explicit fine(spatial_chain(), .5 / 6400);
  fine.advance(6400);
  OrderTable table("spatial chain by Dormand-Prince, t = 0.5 s", {"joint angles [rad]"});
  for (int steps = 200; steps <= 800; steps *= 2) {
    Explicit run(spatial_chain(), .5 / steps);
    run.advance(steps);
    table.add(.5 / steps, {difference(run, fine)});
  }
  table.expect_order(5, .5);
  // The implicit method shares only the equation of motion.
  machines::Run implicit(spatial_chain(), .5 / 5000);
  implicit.advance(5000);
  EXPECT_LT(difference(implicit, fine), 2e-5);
}

// The body of Dzhanibekov: energy and angular momentum are exact invariants of a motion in which it flips
// over.
TEST(ExplicitMethod, FifthOrderOnAFlippingBody) {
  scene::Scene scene = machines::free_body(1, {1, 2, 3}, {0, 0, 0});
  scene.mbd->bodies[0].twist.w_WB = {1e-3, 6, 1e-3};
  const auto momentum = [](machines::Run& run) {
    const Quaterniond q(run.state.q[3], run.state.q[4], run.state.q[5], run.state.q[6]);
    return Vector3d(q * Vector3d(Vector3d(1, 2, 3).cwiseProduct(run.state.u.tail<3>())));
  };
  Explicit fine(scene, 5. / 16000);
  fine.advance(16000);
  OrderTable table("flipping body by Dormand-Prince, t = 5 s",
                   {"orientation [rad]", "angular momentum [N m s]"});
  for (int steps = 250; steps <= 1000; steps *= 2) {
    Explicit run(scene, 5. / steps);
    const Vector3d begin = momentum(run);
    run.advance(steps);
    table.add(5. / steps, {difference(run, fine), (momentum(run) - begin).norm()});
  }
  table.expect_order(5, .6);
}

// A chain of 100 links: what an error costs by either method.
TEST(ExplicitMethod, WorkPrecisionOfAChain) {
  constexpr double end = .2;
  Explicit fine(machines::chain(100), end);
  fine.control(end, 1e-13);
  std::printf("chain of 100 links, t = %.1f s\n%20s %10s %8s %8s %14s %12s %10s\n", end, "method",
              "tolerance", "steps", "rejected", "error [rad]", "energy [J]", "time [ms]");
  double last = 0;
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
    Explicit run(machines::chain(100), end);
    const double energy = run.energy(), cpu = run.control(end, tolerance);
    const double error = (run.state.q - fine.state.q).lpNorm<Eigen::Infinity>();
    const StepCounters& c = run.method.counters();
    std::printf("%20s %10.0e %8lld %8lld %14.2e %12.2e %10.2f\n", "dormand_prince", tolerance,
                static_cast<long long>(c.steps), static_cast<long long>(c.rejected), error,
                std::abs(run.energy() - energy), 1e3 * cpu);
    EXPECT_LT(error, 10 * tolerance);
    if (last > 0) {
      EXPECT_LT(error, .1 * last);
    }
    last = error;
  }
  for (const int steps : {100, 1000}) {
    machines::Run run(machines::chain(100), end / steps, .9, {1e-10, 20});
    const double energy = run.energy(), cpu = run.advance_timed(steps);
    std::printf("%20s %10s %8d %8s %14.2e %12.2e %10.2f\n", "generalized_alpha", "", steps, "",
                (run.state.q - fine.state.q).lpNorm<Eigen::Infinity>(), std::abs(run.energy() - energy),
                1e3 * cpu);
  }
}

// A rod on a motor with PID control and a filter, below its limit, whose target is harmonic: three states of
// second and first order, and the rotor's inertia.
scene::Scene controlled_rod() {
  scene::Scene scene = machines::empty();
  const BodyId rod = machines::add_body(scene, "rod", 2, {.01, 2. / 12, 2. / 12}, {.5, 0, 0});
  const BodyId tip = machines::add_body(scene, "tip", .5, {.01, .02, .02}, {1.2, 0, 0});
  machines::add_joint(scene, "hinge", scene::JointType::revolute, ground, rod, {0, 0, 0}, {0, 1, 0});
  machines::add_joint(scene, "wrist", scene::JointType::revolute, rod, tip, {1, 0, 0}, {0, 1, 0});
  scene::Motor m;
  m.name = "motor", m.joint = JointId{0}, m.control = scene::MotorControl::position;
  m.target = scene::HarmonicMotion{.1, .5, 1.5, 0};
  m.gains = {80, 100, 6, .05, {}};
  m.gear_ratio = 3, m.rotor_inertia = .02;
  scene.mbd->forces.push_back(m);
  m.name = "turn", m.joint = JointId{1}, m.control = scene::MotorControl::speed;
  m.target = scene::ConstantMotion{2, 0}, m.gains = {.5, 2, 0, 0, {}};
  scene.mbd->forces.push_back(m);
  return scene;
}

// A boom on a hydraulic cylinder whose valve opens by a smooth ramp.
scene::Scene hydraulic_boom() {
  scene::Scene scene = machines::empty();
  const BodyId boom = machines::add_body(scene, "boom", 50, {1, 12, 12}, {1, 0, .5});
  machines::add_joint(scene, "foot", scene::JointType::revolute, ground, boom, {0, 0, .2}, {0, 1, 0});
  scene::Cylinder c;
  c.name = "lift", c.body_b = boom, c.point_a = {.4, 0, -.3}, c.point_b = {1, 0, .4};
  c.control = scene::CylinderControl::valve, c.limits = scene::Limits{-.3, .3, 1e8, 1};
  scene::HydraulicData oil;
  oil.bore_area = 2e-3, oil.rod_area = 8e-4, oil.dead_volume = 1e-4;
  oil.supply_pressure = 15e6, oil.tank_pressure = 2e5, oil.valve_flow = 1e-3, oil.laminar_drop = 3e6;
  oil.pressure_a = 3e6, oil.pressure_b = 2e6, oil.leakage = 1e-11;
  c.hydraulics = oil, c.damping = 4e3;
  c.target = scene::HarmonicMotion{.3, .2, 2, 0};
  scene.mbd->forces.push_back(c);
  return scene;
}

struct StateErrors {
  double angle = 0, states = 0;
};
StateErrors state_errors(const machines::Run& run, const machines::Run& fine) {
  return {difference(run, fine), run.system.state_norm(run.state.z - fine.state.z)};
}

// The coordinates of the boom converge faster in these steps, since their errors come from the oil.
TEST(ExplicitMethod, FifthOrderWithStatesOfFirstOrder) {
  const struct {
    const char* name;
    scene::Scene (*make)();
    double end;
    int steps;
  } cases[] = {{"controlled rod", controlled_rod, .5, 20}, {"hydraulic boom", hydraulic_boom, .2, 80}};
  for (const auto& c : cases) {
    Explicit fine(c.make(), c.end / (c.steps * 64));
    fine.advance(c.steps * 64);
    OrderTable table(std::string(c.name) + " by Dormand-Prince", {"states / scale"});
    double last = 0;
    for (int steps = c.steps; steps <= 4 * c.steps; steps *= 2) {
      Explicit run(c.make(), c.end / steps);
      run.advance(steps);
      const StateErrors e = state_errors(run, fine);
      table.add(c.end / steps, {e.states});
      std::printf("%d steps: error of the coordinates %.3e rad, slope %s\n", steps, e.angle,
                  slope_text(last, e.angle).c_str());
      if (last > 0) {
        EXPECT_GT(std::log2(last / e.angle), 4.5);
      }
      last = e.angle;
    }
    table.expect_order(5, .5);
    // The implicit method shares only the forces.
    machines::Run implicit(c.make(), c.end / 20'000, .8, {1e-12, 20});
    implicit.advance(20'000);
    const StateErrors e = state_errors(implicit, fine);
    std::printf(
        "%s by generalized-alpha in 20,000 steps: coordinates differ by %.1e, states by %.1e (1e-7 "
        "allowed)\n",
        c.name, e.angle, e.states);
    EXPECT_LT(e.angle, 1e-7);
    EXPECT_LT(e.states, 1e-7);
  }
}

// The states limit the steps, and the tolerance their error.
TEST(ExplicitMethod, ErrorControlWatchesTheStates) {
  Explicit fine(hydraulic_boom(), .2 / 6400);
  fine.advance(6400);
  double last = 0;
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    Explicit run(hydraulic_boom(), .2);
    run.control(.2, tolerance);
    const StateErrors e = state_errors(run, fine);
    std::printf("hydraulic boom, tolerance %.0e: %d steps, coordinates %.1e, states %.1e\n", tolerance,
                static_cast<int>(run.method.counters().steps), e.angle, e.states);
    EXPECT_LT(e.states, 30 * tolerance);
    if (last > 0) {
      EXPECT_LT(e.states, .2 * last);
    }
    last = e.states;
  }
}

// The energy error of A01 that its budget allows, at every step.
TEST(ExplicitMethod, KeepsTheEnergyOfThePendulum) {
  Explicit run(machines::pendulum(), 10);
  const StepControl control({.tolerance = 1e-5, .max_step = 10});
  const double begin = run.energy();
  double worst = 0;
  while (10 - run.state.time > 1e-12) {
    control.step(run.method, run.system, run.state, 10);
    worst = std::max(worst, std::abs(run.energy() - begin));
  }
  Explicit timed(machines::pendulum(), 10);
  const double cpu = timed.control(10, 1e-5);
  expect_within("A01 by Dormand-Prince, energy over 10 s (budget 0.5 ms)", worst, 5e-5, "J", cpu);
}

}  // namespace explicit_method_test
}  // namespace tandem::mbd
