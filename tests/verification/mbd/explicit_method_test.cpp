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
namespace {

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

}  // namespace
}  // namespace tandem::mbd
