// Springs, dampers and driven joints against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbd_server/io/observation.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace springs_test {

using scene::JointType;

// Mass on a vertical rail under a spring from (0, 0, 2), hanging at z.
scene::Scene hanging(double mass, double stiffness, double damping, double z) {
  scene::Scene scene = machines::empty();
  const BodyId body = machines::add_body(scene, "mass", mass, {1, 1, 1}, {0, 0, z});
  machines::add_joint(scene, "rail", JointType::prismatic, ground, body, {0, 0, z});
  scene.mbd->forces.push_back(
      scene::SpringDamper{"spring", ground, body, {0, 0, 2}, {0, 0, z}, stiffness, damping, 2 - z});
  return scene;
}

// From the unstretched length: z = -d (1 - e^(-c t) (cos w t + c/w sin w t)), d = m g / k, c = b / 2m.
TEST(SpringMass, FollowsTheDampedOscillation) {
  const double m = 2, k = 800, b = 4, t = 1;
  const double d = m * 9.81 / k, c = b / (2 * m), w = std::sqrt(k / m - c * c);
  const double decay = std::exp(-c * t);
  const double z = -d * (1 - decay * (std::cos(w * t) + c / w * std::sin(w * t)));
  const double v = -d * decay * (w + c * c / w) * std::sin(w * t);
  OrderTable table("spring, mass, damper at t = 1 s, rho_inf = 0.8");
  for (int n = 1000; n <= 8000; n *= 2) {
    machines::Run run(hanging(m, k, b, 0), t / n, 0.8);
    run.advance(n);
    table.add(t / n, {std::abs(run.position(0).z() - z), std::abs(run.velocity(0).z() - v)});
  }
  table.expect_order(2.0, 0.1);
}

// Frequency of an undamped oscillation as counted from its zero crossings.
TEST(SpringMass, FrequencyErrorFallsWithTheSquareOfTheStep) {
  const double m = 1, k = 400, exact = std::sqrt(k / m) / (2 * std::numbers::pi);
  std::printf("%10s %12s %14s %7s   (f = %.6f Hz exactly)\n", "h [s]", "f [Hz]", "relative error", "slope",
              exact);
  double last = 0;
  for (const double h : {4e-3, 2e-3, 1e-3, 5e-4}) {
    machines::Run run(hanging(m, k, 0, 0), h, 0.9);
    const double middle = -m * 9.81 / k;
    double first = -1, latest = -1, before = run.position(0).z() - middle;
    int crossings = 0;
    for (int i = 1; i * h < 6; ++i) {
      run.advance(1);
      const double now = run.position(0).z() - middle;
      if (before < 0 && now >= 0) {
        latest = (i - now / (now - before)) * h;
        if (first < 0)
          first = latest;
        else
          ++crossings;
      }
      before = now;
    }
    const double f = crossings / (latest - first), error = std::abs(f / exact - 1);
    std::printf("%10.1e %12.6f %14.3e %7s\n", h, f, error, slope_text(last, error).c_str());
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.1);
    }
    last = error;
  }
  EXPECT_LT(last, 1e-4);
}

// k = 1e9 N/m on 1 kg: 2e-4 s per period, steps of 1e-2 s. The static sag is exact, the oscillation dies out.
TEST(StiffSpring, IsStableAtStepsFarAboveItsPeriod) {
  for (const double rho : {0.5, 0.8, 0.95}) {
    machines::Run run(hanging(1, 1e9, 0, 0), 1e-2, rho, {1e-10, 20});
    // A displaced start: it would have to swing by 1e-6 m at 31,623 rad/s.
    run.restart([](State& s) { s.q[0] = 1e-6; });
    double largest = 0;
    for (int i = 0; i < 1000; ++i) {
      run.advance(1);
      largest = std::max(largest, std::abs(run.state.q[0]));
    }
    const double sag = -9.81 / 1e9;
    std::printf(
        "k = 1e9 N/m, h = 1e-2 s, rho_inf %.2f: largest |z| %.2e m, at the end %.6e m, exact sag %.6e m\n",
        rho, largest, run.state.q[0], sag);
    // Generalized-alpha overshoots an inconsistently stiff start once, the more the smaller rho_inf.
    EXPECT_LT(largest, 1e-5);
    EXPECT_NEAR(run.state.q[0], sag, 1e-14);
  }
}

// The same under loads that jump at every step: bounded by a few times the static answer.
TEST(StiffSpring, StaysBoundedUnderLoadsThatJump) {
  scene::Scene scene = hanging(1, 1e9, 0, 0);
  machines::add_wall(scene, BodyId{0});
  machines::Run run(scene, 1e-3, 0.8, {1e-10, 20});
  double largest = 0;
  for (int i = 0; i < 5000; ++i) {
    run.state.loads(5, 0) = i % 2 == 0 ? 100 : -100;
    run.integrator.jump(run.system, run.state);
    run.advance(1);
    largest = std::max(largest, std::abs(run.state.q[0]));
  }
  std::printf("k = 1e9 N/m under +-100 N: largest |z| %.2e m, statically %.2e m\n", largest, 110 / 1e9);
  EXPECT_LT(largest, 1e-4);
}

// A bead on a rail that a motion turns at constant rate: r'' = w^2 r, so r = r0 cosh w t.
TEST(PrescribedMotion, FlingsABeadAlongATurningRail) {
  const double w = 3, t = 1;
  OrderTable table("bead on a turning rail at t = 1 s, rho_inf = 0.9");
  for (int n = 500; n <= 4000; n *= 2) {
    scene::Scene scene = machines::empty({0, 0, 0});
    const BodyId rail = machines::add_body(scene, "rail", 1, {1, 1, 1}, {0, 0, 0});
    const BodyId bead = machines::add_body(scene, "bead", .5, {.1, .1, .1}, {.2, 0, 0});
    machines::add_joint(scene, "drive", JointType::revolute, ground, rail, {0, 0, 0}).motion =
        scene::ConstantMotion{0, w};
    machines::add_joint(scene, "slide", JointType::prismatic, rail, bead, {0, 0, 0}, {1, 0, 0});
    machines::Run run(scene, t / n);
    run.advance(n);
    const double r = .2 * std::cosh(w * t), v = std::hypot(.2 * w * std::sinh(w * t), w * r);
    const Vector3d exact(r * std::cos(w * t), r * std::sin(w * t), 0);
    table.add(t / n, {(run.position(1) - exact).norm(), std::abs(run.velocity(1).norm() - v)});
  }
  table.expect_order(2.0, 0.1);
}

TEST(DoublePendulum, EnergyErrorFallsWithTheSquareOfTheStep) {
  std::printf("double pendulum from the horizontal, 5 s, rho_inf = 0.9\n%10s %16s %7s\n", "h [s]",
              "energy error [J]", "slope");
  double last = 0;
  for (const double h : {1e-3, 5e-4, 2.5e-4, 1.25e-4}) {
    scene::Scene scene = machines::pendulum();
    const BodyId second = machines::add_body(scene, "second", 1, {0, 0, 0}, {-2, 0, 0});
    machines::add_joint(scene, "pin2", JointType::revolute, BodyId{0}, second, {-1, 0, 0});
    machines::Run run(scene, h);
    double worst = 0;
    for (int i = 0; i < std::lround(5 / h); ++i) {
      run.advance(1);
      run.system.residual(run.state);
      worst = std::max(worst, std::abs(energy(run.model, run.state, run.system.links())));
    }
    std::printf("%10.2e %16.3e %7s\n", h, worst, slope_text(last, worst).c_str());
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / worst), 2, 0.15);
    }
    last = worst;
  }
}

}  // namespace springs_test
}  // namespace tandem::mbd
