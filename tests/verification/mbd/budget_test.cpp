// Accuracy that is asked for within a budget of processor time: the error is tested, the time is printed (of
// the steps alone, without start-up). Andrews' squeezer with its work-precision curve.
#include <gtest/gtest.h>

#include <cmath>

#include "common/cpu_time.hpp"
#include "mbd_server/step/richardson.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace budget_test {

TEST(Budget, SimplePendulumKeepsItsEnergy) {
  machines::Run run(machines::shipped("simple_pendulum"), 10.0 / 4050, 0.9, {1e-10, 20});
  const double start = run.energy();
  double worst = 0, cpu = 0;
  for (int i = 0; i < 4050; ++i) {
    cpu += run.advance_timed(1);
    worst = std::max(worst, std::abs(run.energy() - start));
  }
  // Again in one go: reading the clock costs as much as a step.
  machines::Run timed(machines::shipped("simple_pendulum"), 10.0 / 4050, 0.9, {1e-10, 20});
  cpu = timed.advance_timed(4050);
  expect_within("A01, 4050 steps, energy over 10 s (budget 5 ms)", worst, 5e-5, "J", cpu);
}

std::vector<double> squeezer_angles(machines::Run& run) {
  std::vector<double> angles;
  for (const scene::Check& check : run.scene.checks)
    angles.push_back(run.joint(check.of.substr(0, check.of.find('.'))).q);
  return angles;
}

// Largest error of the seven angles, each relative to its value: the tolerance of a check is 1e-3 of the
// angle.
double squeezer_error(const scene::Scene& scene, const std::vector<double>& angles) {
  double worst = 0;
  for (std::size_t i = 0; i < angles.size(); ++i)
    worst =
        std::max(worst, 1e-3 * std::abs(angles[i] - scene.checks[i].expected) / scene.checks[i].tolerance);
  return worst;
}

TEST(Squeezer, ConvergesToTheReference) {
  const scene::Scene scene = machines::shipped("squeezer");
  OrderTable table("Andrews' squeezer, t = 0.03 s, index 2, rho_inf = 0.9", {"angles"});
  for (int n = 500; n <= 16000; n *= 2) {
    machines::Run run(scene, .03 / n, 0.9, {1e-11, 20});
    const double cpu = run.advance_timed(n);
    const StepCounters& c = run.integrator.counters();
    const double error = squeezer_error(scene, squeezer_angles(run));
    std::printf("%6d steps: relative error %.2e, %.2f ms, %.2f iterations and %.2f factorisations per step\n",
                n, error, 1e3 * cpu, double(c.newton_iterations) / double(c.steps),
                double(c.factorisations) / double(c.steps));
    if (n >= 2000) table.add(.03 / n, {error});
  }
  table.expect_order(2.0, 0.1);
}

// What a higher order buys.
TEST(Squeezer, ExtrapolatedIsBelow1e7InATenthOfTheTime) {
  const scene::Scene scene = machines::shipped("squeezer");
  for (int n = 250; n <= 4000; n *= 2) {
    const double h = .03 / n;
    machines::Run run(scene, h, 0.9, {1e-11, 20});
    Richardson richardson(run.integrator, run.state);
    richardson.start(run.system, run.state, h);
    const double begin = cpu_seconds(CpuClock::thread);
    for (int i = 0; i < n; ++i) richardson.step(run.system, run.state, h);
    const double cpu = cpu_seconds(CpuClock::thread) - begin;
    const double error = squeezer_error(scene, squeezer_angles(run));
    std::printf("%6d steps, extrapolated: relative error %.2e, %.2f ms\n", n, error, 1e3 * cpu);
    if (n == 1000) {
      EXPECT_LT(error, 1e-7);
    }
  }
}

TEST(Budget, SqueezerAt1e3) {
  machines::Run run(machines::shipped("squeezer"), .03 / 400, 0.9, {1e-7, 20});
  const double cpu = run.advance_timed(400);
  expect_within("Andrews' squeezer (budget 20 ms)", squeezer_error(run.scene, squeezer_angles(run)), 1e-3,
                "-", cpu);
}

TEST(Budget, GovernorAt1e4) {
  machines::Run run(machines::shipped("governor"), 1.25e-3, 0.9, {1e-8, 20});
  const double cpu = run.advance_timed(8000);
  expect_within("A05 governor, slider after 10 s (budget 100 ms)",
                std::abs(run.position(1).z() - 0.619622917061), 1e-4, "m", cpu);
}

}  // namespace budget_test
}  // namespace tandem::mbd
