// Error of bodies that touch over the number of steps, where error control chooses these: a table for each
// case, and the order over all of it. Within an impact the method is of second order.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <optional>

#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace {

using namespace contacts;

struct OrderCase {
  const char* name;
  ContactScene scene;
  double end;                                   // [s]
  std::function<double(ContactRun&)> measured;  // [m]
  std::optional<double> exact{};                // [m]; none: a run with a thousandth of the least tolerance
  double least_order = 1.7;                     // over the number of steps
};

struct Measured {
  double value, steps;
};

Measured run_with(const OrderCase& c, double tolerance) {
  scene::Scene scene = c.scene.scene;
  scene.mbd->integrator.error_tolerance = tolerance;
  ContactRun run(scene, 1e-2);
  run.advance(static_cast<int>(std::lround(c.end / run.window)));
  return {c.measured(run), run.facts().at("mbd_steps").get<double>()};
}

void expect_order(const OrderCase& c) {
  constexpr double coarse = 1e-6, fine = 1e-10;
  const double right = c.exact ? *c.exact : run_with(c, 1e-3 * fine).value;
  double first = 0, fewest = 0, error = 0, steps = 0;
  for (double tolerance = coarse; tolerance > 0.5 * fine; tolerance /= 10) {
    const Measured now = run_with(c, tolerance);
    error = std::abs(now.value - right), steps = now.steps;
    if (first == 0) first = error, fewest = steps;
    std::printf("  %-34s error_tolerance %.0e steps %6.0f error %.2e m\n", c.name, tolerance, steps, error);
  }
  const double order = std::log(first / error) / std::log(steps / fewest);
  std::printf("  %-34s order over the steps: expected at least %.1f measured %.2f\n", c.name, c.least_order,
              order);
  EXPECT_GE(order, c.least_order) << c.name;
}

ContactScene ball_on_floor(double height, double restitution, double friction, Vec3d velocity) {
  ContactScene s;
  s.add_floor();
  s.add_ball("ball", 1, 0.05, {0, 0, 0.05 + height});
  s.body({0}).twist.v_WB = velocity;
  s.material() = {"stuff", 1e6, 0, 0, restitution, friction};
  return s;
}

double height_of(ContactRun& run) {
  return run.position().z - 0.05;
}
double way_of(ContactRun& run) {
  return run.position().x;
}

// A ball of 1 kg on a spring k that falls and rises without loss: d(t) = mg/k (1 - cos wt) + v/w sin wt while
// it is in contact.
double bounced(double fall, double k, double time) {
  const double w = std::sqrt(k), v = std::sqrt(2 * g * fall),
               in_contact = 2 * (std::numbers::pi - std::atan(v * w / g)) / w,
               t = std::fmod(time - v / g, in_contact + 2 * v / g) - in_contact;
  return v * t - 0.5 * g * t * t;
}

TEST(ContactOrder, BallBouncesWithoutLoss) {
  expect_order(
      {"ball bounces, restitution 1", ball_on_floor(0.2, 1, 0, {}), 1, height_of, bounced(0.2, 1e6, 1)});
}

TEST(ContactOrder, BallBouncesWithLoss) {
  expect_order({"ball bounces, restitution 0.8", ball_on_floor(0.2, 0.8, 0, {}), 1, height_of});
}

TEST(ContactOrder, TwoBallsCollide) {
  constexpr double m1 = 1, m2 = 3, k = 1e6, v = 2, apart = 0.1, end = 0.2;
  ContactScene s({0, 0, 0});
  s.add_ball("one", m1, 0.05, {0, 0, 0});
  s.add_ball("two", m2, 0.05, {0.1 + apart, 0, 0});
  s.body({0}).twist.v_WB = {v, 0, 0};
  s.material() = {"stuff", k, 0, 0, 1, 0};
  const double in_contact = std::numbers::pi * std::sqrt(m1 * m2 / (m1 + m2) / k), met = apart / v,
               centre = m1 * v / (m1 + m2), after = v * (m1 - m2) / (m1 + m2);
  expect_order(
      {"two balls collide", s, end, way_of, apart + centre * in_contact + after * (end - met - in_contact)});
}

// It stops after v^2 / (2 mu g), and the springs of friction of its four corners take it back by their
// stretch; that friction tilts it by 4e-6 rad is left out there. The method integrates constant forces
// without an error.
TEST(ContactOrder, BoxSlidesToAStop) {
  constexpr double k = 1e6, mu = 0.3;
  OrderCase c{"box slides to a stop", ContactScene(), 0.5, way_of};
  c.scene.add_floor();
  c.scene.add_box("box", 1, {0.2, 0.2, 0.1}, {0, 0, 0.05 - g / (4 * k)});
  c.scene.body({0}).twist.v_WB = {1, 0, 0};
  c.scene.material() = {"stuff", k, 0, 0, 0.5, mu};
  const double finest = run_with(c, 1e-11).value;
  expect_near("way of a box to its stop [m]", finest, 1 / (2 * mu * g) - mu * g / (4 * k * 2 / 7), 1e-6);
  for (const double tolerance : {1e-6, 1e-8, 1e-10})
    expect_near("the same at another error_tolerance [m]", run_with(c, tolerance).value, finest, 1e-10);
}

TEST(ContactOrder, BallSlidesUntilItRolls) {
  expect_order({"ball slides until it rolls", ball_on_floor(0, 0.5, 0.3, {1, 0, 0}), 1, way_of, {}, 1.3});
}

// Wherever in a step the impact begins and ends.
TEST(ContactOrder, AnElasticImpactKeepsItsEnergyAtEachPhase) {
  for (const bool hertz : {false, true})
    for (const double window : {2e-2, 1e-2, 1e-3}) {
      double most = 0, least = 0;
      for (int i = 0; i < 40; ++i) {
        ContactScene s({0, 0, 0});
        s.add_floor();
        s.add_ball("ball", 1, 0.1, {0, 0, 0.101 + 0.01 * std::fmod(i * 0.6180339887, 1)});
        s.body({0}).twist.v_WB = {0, 0, -1};
        s.material().restitution = 1;
        if (hertz) s.material().stiffness.reset(), s.material().young = 1e8, s.material().poisson = 0.3;
        ContactRun run(s.scene, window);
        run.advance(static_cast<int>(0.06 / window));
        EXPECT_GT(run.velocity().z, 0);
        const double gain = dot(run.velocity(), run.velocity()) - 1;
        most = std::max(most, gain), least = std::min(least, gain);
      }
      const std::string what = std::string(hertz ? "Hertz" : "linear") + ", windows of " +
                               std::to_string(window) + " s: share of energy that is ";
      expect_near(what + "gained", most, 0, 5e-4);
      expect_near(what + "lost", -least, 0, 5e-4);
    }
}

}  // namespace
}  // namespace tandem::mbd
