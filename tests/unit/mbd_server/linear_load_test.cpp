// Loads that are linear in time over a window, and paths with the accelerations held.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using protocol::BodyMotion;
using protocol::LoadSet;

constexpr double H = 1e-3;  // [s]

LoadSet load_over(std::uint64_t n, Vec3d mean, Vec3d moment) {
  const auto begin = static_cast<std::int64_t>(n) * 1'000'000;
  LoadSet set;
  set.window = {n, {begin}, {begin + 1'000'000}};
  set.bodies.resize(1);
  set.bodies[0].mean.force = mean;
  set.bodies[0].first_moment.force = moment;
  return set;
}

// Of any size, with jumps of value and slope at every end of a window.
LoadSet rough_load(std::uint64_t n) {
  const double s = static_cast<double>(n);
  return load_over(n, {10 * std::sin(s), -7 * std::cos(2 * s), 12},
                   {H * std::cos(3 * s), 2 * H * std::sin(s), -H * std::cos(s)});
}

scene::Scene free_body() {
  scene::Scene scene = machines::free_body(2.5, {.1, .2, .3}, {0, 0, 0});
  machines::add_wall(scene, BodyId{0});
  return scene;
}

// The impulse is that of the mean for any slope, every rho_inf and number of steps.
TEST(LinearLoad, FreeBodyGainsTheImpulseOfTheMean) {
  for (const double rho : {0.0, 0.8, 1.0})
    for (const double step : {H, H / 3}) {
      scene::Scene scene = free_body();
      scene.mbd->integrator.rho_inf = rho;
      scene.mbd->integrator.step = step;
      MbdSolver solver;
      solver.configure(scene);
      Vec3d recorded, offered, v;
      for (std::uint64_t n = 0; n < 300; ++n) {
        const LoadSet set = rough_load(n);
        const BodyMotion& motion = solver.advance(set).bodies[0];
        recorded += motion.applied_impulse.force;
        offered += H * set.bodies[0].mean.force;
        v = motion.end_twist.v_WB;
      }
      const double scale = norm(offered);
      std::printf(
          "  rho_inf %.1f, %.0f steps a window: gained - offered %.1e, recorded - offered %.1e of %.3g N s; "
          "tolerance 1e-12\n",
          rho, H / step, norm(2.5 * v - offered), norm(recorded - offered), scale);
      EXPECT_LT(norm(2.5 * v - offered), 1e-12 * scale);
      EXPECT_LT(norm(recorded - offered), 1e-13 * scale);
    }
}

TEST(LinearLoad, WorkIsTheGainOfKineticEnergy) {
  MbdSolver solver;
  solver.configure(free_body());
  const double start = solver.observe().energy;
  double work = 0, gross = 0;
  for (std::uint64_t n = 0; n < 300; ++n) {
    const double w = solver.advance(rough_load(n)).bodies[0].applied_work;
    work += w;
    gross += std::abs(w);
  }
  const double gained = solver.observe().energy - start;
  // The displacement of a step has an error of h^3, along which the load's work is integrated.
  std::printf("  gained %.9e J, recorded %.9e J, gross %.3e J\n", gained, work, gross);
  EXPECT_NEAR(work, gained, 2e-3 * gross);
}

// F = sin(w t), given by its exact mean and first moment over each window: x = t / (m w) - sin(w t) / (m
// w^2).
TEST(LinearLoad, IsOfSecondOrder) {
  const double w = 40, m = 2.5, end = 0.3;
  double last = 0;
  for (const int steps : {1, 2, 4}) {
    scene::Scene scene = free_body();
    MbdSolver solver;
    scene.mbd->integrator.step = H / steps;
    solver.configure(scene);
    double x = 0, v = 0;
    for (std::uint64_t n = 0; n < 300; ++n) {
      const double a = static_cast<double>(n) * H, b = a + H, middle = a + H / 2;
      const double mean = (std::cos(w * a) - std::cos(w * b)) / (w * H);
      // (1/H) integral of (t - t_mid) sin(w t) dt
      const double moment = ((std::sin(w * b) - std::sin(w * a)) / (w * w) -
                             ((b - middle) * std::cos(w * b) - (a - middle) * std::cos(w * a)) / w) /
                            H;
      const BodyMotion& motion = solver.advance(load_over(n, {mean, 0, 0}, {moment, 0, 0})).bodies[0];
      x = motion.end_pose.p_WB.x;
      v = motion.end_twist.v_WB.x;
    }
    const double exact = end / (m * w) - std::sin(w * end) / (m * w * w);
    const double error = std::abs(x - exact);
    std::printf("  %d steps a window: error of x %.3e m", steps, error);
    EXPECT_NEAR(v, (1 - std::cos(w * end)) / (m * w), 1e-13);
    if (last > 0) {
      std::printf(", order %.2f", std::log2(last / error));
      EXPECT_GT(std::log2(last / error), 1.9);
    }
    std::printf("\n");
    last = error;
  }
}

TEST(Extrapolate, HoldsTheAccelerationAndLeavesTheStateAlone) {
  MbdSolver solver;
  solver.configure(free_body());
  for (std::uint64_t n = 0; n < 5; ++n) solver.advance(rough_load(n));
  const std::string before = hash(solver.state());
  const Window window{5, {5'000'000}, {6'000'000}};
  const BodyMotion path = solver.extrapolate(window).bodies[0];
  EXPECT_EQ(hash(solver.state()), before);
  // The load at the end of the last window, divided by the mass.
  const protocol::BodyLoad load = rough_load(4).bodies[0];
  const Vec3d a = (1 / 2.5) * (load.mean.force + 6 / H * load.first_moment.force);
  EXPECT_LT(norm(path.begin_a - a), 1e-10 * norm(a));
  EXPECT_LT(norm(path.end_twist.v_WB - path.begin_twist.v_WB - H * a), 1e-12 * norm(a));
  EXPECT_LT(norm(path.end_pose.p_WB - path.begin_pose.p_WB - H * path.begin_twist.v_WB - H * H / 2 * a),
            1e-15 * norm(a));
  EXPECT_EQ(path.applied_work, 0);
  // predict holds the velocity.
  const BodyMotion straight = solver.predict(window).bodies[0];
  EXPECT_EQ(straight.end_twist.v_WB, straight.begin_twist.v_WB);
}

// About one axis the error of the path with constant acceleration is of order h^3, that of the straight path
// h^2.
TEST(Extrapolate, IsAnOrderBetterThanPredict) {
  double straight_error = 0, held_error = 0;
  for (const int k : {1, 2}) {
    scene::Scene scene = machines::empty();
    const BodyId body = machines::add_body(scene, "rod", 1, {.1, .1, .1}, {0.5, 0, 0});
    machines::add_joint(scene, "pin", scene::JointType::revolute, ground, body, {0, 0, 0}, {0, 1, 0});
    machines::add_wall(scene, body);
    scene.gravity = {0, 0, -9.81};
    scene.mbd->integrator.step = 1e-4;
    MbdSolver solver;
    solver.configure(scene);
    const std::int64_t length = 40'000'000 / k;
    LoadSet none;
    for (int n = 0; n < 5 * k; ++n) {
      none.window = {static_cast<std::uint64_t>(n), {n * length}, {(n + 1) * length}};
      solver.advance(none);
    }
    none.window = {static_cast<std::uint64_t>(5 * k), {200'000'000}, {200'000'000 + length}};
    const Vec3d straight = solver.predict(none.window).bodies[0].end_pose.p_WB;
    const Vec3d held = solver.extrapolate(none.window).bodies[0].end_pose.p_WB;
    const Vec3d taken = solver.advance(none).bodies[0].end_pose.p_WB;
    const double s = norm(straight - taken), h = norm(held - taken);
    if (k == 2) {
      std::printf("  order of the path: velocity held %.2f, acceleration held %.2f\n",
                  std::log2(straight_error / s), std::log2(held_error / h));
      EXPECT_NEAR(std::log2(straight_error / s), 2, 0.15);
      EXPECT_NEAR(std::log2(held_error / h), 3, 0.15);
    }
    straight_error = s;
    held_error = h;
  }
}

}  // namespace
}  // namespace tandem::mbd
