// Stops and dry friction of joints in motion, against closed forms.
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

// Time of the n-th upward crossing of zero, by the line between the two steps.
double crossing(machines::Run& run, int n) {
  for (double before = run.state.q[0];; before = run.state.q[0]) {
    run.advance(1);
    const double now = run.state.q[0];
    if (before < 0 && now >= 0 && --n == 0) return run.state.time - run.step * now / (now - before);
  }
}

// Between stops at -L and L: two flights of 2 L / v and two half oscillations of pi sqrt(m / k).
TEST(Stops, BounceWithThePeriodOfFlightAndContact) {
  const double m = 2, v = 1.5, L = .1, k = 2e5;
  const double exact = 4 * L / v + 2 * pi * std::sqrt(m / k);
  std::printf("bead between stops, rho_inf = 0.9: period of %.9f s\n%10s %13s %13s\n", exact, "h [s]",
              "error [s]", "speed error");
  double last = 0, speed = 0;
  for (const double h : {1e-4, 5e-5, 2.5e-5, 1.25e-5}) {
    scene::Scene scene = bead(m, v);
    scene.mbd->joints[0].limits = scene::Limits{-L, L, k, 0};
    machines::Run run(scene, h);
    last = std::abs(crossing(run, 6) / 6 - exact);
    speed = std::abs(run.state.u[0] - v);
    std::printf("%10.2e %13.3e %13.3e\n", h, last, speed);
  }
  // The error depends on the position in a step at which a contact begins: it has no order.
  EXPECT_LT(last, 5e-6 * exact);
  EXPECT_LT(speed, 1e-5 * v);
}

// Damping of [Hunt1975]: m v dv = -k d (1 + c v) dd, from v0 at the entry to v1 at the exit, gives c (v0 +
// v1) = ln((1 + c v0) / (1 - c v1)).
double rebound(double c, double v0) {
  double low = 0, high = std::min(v0, (1 - 1e-12) / c);
  for (int i = 0; i < 100; ++i) {
    const double v1 = (low + high) / 2;
    (std::log((1 + c * v0) / (1 - c * v1)) < c * (v0 + v1) ? low : high) = v1;
  }
  return low;
}

TEST(Stops, ReboundAsTheirDampingSays) {
  std::printf("%10s %10s %12s %12s %10s\n", "c [s/m]", "v0 [m/s]", "v1 expected", "measured", "tolerance");
  for (const double c : {.05, .3, 2.})
    for (const double v0 : {.5, 2.}) {
      scene::Scene scene = bead(1, v0);
      scene.mbd->joints[0].limits = scene::Limits{-1, .01, 1e5, c};
      machines::Run run(scene, 1e-5);
      while (run.state.u[0] > 0 || run.state.q[0] > .01) run.advance(1);
      const double v1 = rebound(c, v0);
      std::printf("%10.2f %10.2f %12.7f %12.7f %10.0e\n", c, v0, v1, -run.state.u[0], 1e-4 * v1);
      EXPECT_NEAR(-run.state.u[0], v1, 1e-4 * v1);
    }
}

// A body on its stop is at rest at its static depth: m g / k beyond the limit.
TEST(Stops, CarryAWeightAtRest) {
  scene::Scene scene = machines::empty();
  const BodyId body = machines::add_body(scene, "lift", 3, {1, 1, 1}, {0, 0, 0});
  scene::Joint& rail = machines::add_joint(scene, "rail", JointType::prismatic, ground, body, {0, 0, 0});
  rail.limits = scene::Limits{-.2, .5, 1e6, 1};
  rail.damping = 200;
  machines::Run run(scene, 1e-3, .5);
  run.advance(3000);
  EXPECT_NEAR(run.state.q[0], -.2 - 3 * 9.81 / 1e6, 1e-12);
}

// A body that is moved away from its stop faster than 1 / c gets no force: a stop pushes and does not pull.
TEST(Stops, DoNotPull) {
  const double c = 2;
  scene::Scene scene = bead(1, 0);
  scene.mbd->joints[0].limits = scene::Limits{-1, 0, 1e4, c};
  machines::Run run(scene, 1e-5);
  run.restart([c](State& s) { s.q[0] = .01, s.u[0] = -3 / c; });
  EXPECT_EQ(run.state.udot[0], 0);
  run.advance(100);
  EXPECT_EQ(run.state.u[0], -3 / c);
}

// Below the friction force a body creeps at slip atanh(F / f), above it the excess force accelerates it.
TEST(Friction, HoldsUpToItsForce) {
  const double m = 2, f = 5, slip = 1e-4;
  for (const double share : {.3, .9, 1.2, 3.}) {
    scene::Scene scene = bead(m, 0);
    scene.mbd->joints[0].friction = scene::Friction{f, slip};
    scene.mbd->forces.push_back(scene::Actuator{"push", JointId{0}, scene::ConstantMotion{share * f, 0}});
    machines::Run run(scene, 1e-4, .8, {1e-13, 50});
    run.advance(5000);
    const double u = run.state.u[0];
    if (share < 1) {
      std::printf("push of %.1f f: creeps at %.6e m/s, slip atanh(F/f) = %.6e\n", share, u,
                  slip * std::atanh(share));
      EXPECT_NEAR(u, slip * std::atanh(share), 1e-9 * slip);
    } else {
      // The full friction acts except in the first steps, where the rate passes slip.
      const double exact = (share - 1) * f / m * .5;
      std::printf("push of %.1f f: %.6f m/s after 0.5 s, (F - f) t / m = %.6f\n", share, u, exact);
      EXPECT_NEAR(u, exact, 2e-3 * exact);
    }
  }
}

// m v dv/dx = -f tanh(v / s): until it stops, a body moves by m / f times the integral of v / tanh(v / s),
// and sinh(v / s) = sinh(v0 / s) exp(-f t / (m s)).
struct Sliding {
  double m = 2, f = 5, slip = .3, v0 = 1;

  double speed(double t) const {
    return slip * std::asinh(std::sinh(v0 / slip) * std::exp(-f * t / (m * slip)));
  }
  double way_to_rest(double v) const {
    const int cells = 1000;  // for Simpson's rule
    const auto y = [&](int i) {
      return i == 0 ? slip : v * i / (2 * cells) / std::tanh(v * i / (2 * cells) / slip);
    };
    double sum = 0;
    for (int i = 0; i < cells; ++i) sum += y(2 * i) + 4 * y(2 * i + 1) + y(2 * i + 2);
    return m / f * sum * v / (6 * cells);
  }
  scene::Scene scene() const {
    scene::Scene scene = bead(m, v0);
    scene.mbd->joints[0].friction = scene::Friction{f, slip};
    return scene;
  }
};

TEST(Friction, SlowsABodyDown) {
  const Sliding s;
  const double t = .5;
  OrderTable table("bead under friction after 0.5 s, rho_inf = 0.9");
  for (int n = 250; n <= 2000; n *= 2) {
    machines::Run run(s.scene(), t / n);
    run.advance(n);
    table.add(t / n, {std::abs(run.state.q[0] - (s.way_to_rest(s.v0) - s.way_to_rest(s.speed(t)))),
                      std::abs(run.state.u[0] - s.speed(t))});
  }
  table.expect_order(2, .1);
}

// With a small slip that is Coulomb's m v0^2 / 2 f, plus m s^2 pi^2 / 12 f.
TEST(Friction, StopsABodyWhereCoulombSays) {
  Sliding s;
  s.slip = .05;
  const double coulomb = s.m * s.v0 * s.v0 / (2 * s.f),
               exact = coulomb + s.m * s.slip * s.slip * pi * pi / (12 * s.f);
  machines::Run run(s.scene(), 5e-4);
  run.advance(3000);
  std::printf("stops after %.9f m; exact %.9f m, Coulomb without regularisation %.9f m\n", run.state.q[0],
              exact, coulomb);
  EXPECT_NEAR(run.state.q[0], exact, 1e-6 * exact);
  EXPECT_NEAR(s.way_to_rest(s.v0), exact, 1e-12);
}

// A wheel with friction torque T slows down at T / J.
TEST(Friction, SlowsAWheel) {
  const double J = .02, T = .1, w0 = 30;
  scene::Scene scene = machines::empty();
  const BodyId wheel = machines::add_body(scene, "wheel", 1, {J, J, J}, {0, 0, 0});
  scene::Joint& axle = machines::add_joint(scene, "axle", JointType::revolute, ground, wheel, {0, 0, 0});
  axle.rate = w0;
  axle.friction = scene::Friction{T, 1e-3};
  machines::Run run(scene, 1e-3);
  run.advance(2000);
  EXPECT_NEAR(run.state.u[0], w0 - T / J * 2, 1e-9);
}

}  // namespace
}  // namespace tandem::mbd
