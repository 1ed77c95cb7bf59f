// Rebound from stops: stiffness x step x restitution, through the solver as a run uses it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace stops_test {

constexpr double g = 9.81, fall = 0.1, window_s = 0.01;

struct Method {
  std::optional<double> step, tolerance;
  double rho_inf = 0.9;
};

// 1 kg falls 0.1 m on a rail that ends in a stop.
scene::Scene drop(const scene::Limits& limits, const Method& method) {
  scene::Scene scene = machines::empty({0, 0, -g});
  const BodyId body = machines::add_body(scene, "b", 1, {.1, .1, .1}, {0, 0, 0});
  machines::add_joint(scene, "j", scene::JointType::prismatic, ground, body, {0, 0, 0}).limits = limits;
  scene.coupling.window = window_s;
  scene.mbd->integrator.step = method.step;
  scene.mbd->integrator.error_tolerance = method.tolerance;
  scene.mbd->integrator.rho_inf = method.rho_inf;
  return scene;
}

void advance(MbdSolver& solver, std::uint64_t n) {
  const auto H = static_cast<std::int64_t>(window_s * 1e9);
  protocol::LoadSet none;
  none.window = {n, {static_cast<std::int64_t>(n) * H}, {static_cast<std::int64_t>(n + 1) * H}};
  solver.advance(none);
}

bool flies(const State& s) {
  return s.stops.row(StopRow::entry_rate).isZero(0);
}

// Height above the stop that the body reaches after its first contact, 0 where it stays there [m].
double rebound(const scene::Limits& limits, const Method& method) {
  MbdSolver solver;
  solver.configure(drop(limits, method));
  for (std::uint64_t n = 0; n < 50; ++n) {
    advance(solver, n);
    const State& s = solver.state();
    if (s.u[0] > 0 && flies(s)) return s.q[0] + fall + s.u[0] * s.u[0] / (2 * g);
  }
  return 0;
}

// d'' = g - k d (1 + c d') from d' = v, Runge-Kutta with some 1e5 steps; m = 1 kg. The rate at which it ends;
// 0 where the weight keeps the body on the stop.
double exit_rate(double k, double c, double v) {
  const auto f = [&](double d, double r) { return g - k * d * std::max(0.0, 1 + c * r); };
  const double h = 1e-4 / std::sqrt(k) / std::sqrt(1 + c * v);
  double d = 0, r = v;
  for (double t = 0; t < 50 / std::sqrt(k); t += h) {
    const double k1 = f(d, r), k2 = f(d + h / 2 * r, r + h / 2 * k1),
                 k3 = f(d + h / 2 * (r + h / 2 * k1), r + h / 2 * k2),
                 k4 = f(d + h * (r + h / 2 * k2), r + h * k3);
    const double d1 = d + h * r + h * h / 6 * (k1 + k2 + k3), r1 = r + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    if (d1 <= 0) return r + (r1 - r) * d / (d - d1);
    d = d1, r = r1;
  }
  return 0;
}

// c v of a restitution e, by its definition: without gravity the law returns e v.
double damping_of(double e) {
  if (e == 1) return 0;
  double low = 1e-9, high = 1 / e;
  for (int i = 0; i < 200; ++i) {
    const double x = (low + high) / 2;
    ((1 + x) / (1 - e * x) < std::exp((1 + e) * x) ? low : high) = x;
  }
  return low;
}

TEST(StopRebound, IsRightUnderErrorControlAndNeverAboveTheDropHeight) {
  const double v = std::sqrt(2 * g * fall);
  std::printf(
      "rebound / (e^2 h), 1 kg from 0.1 m; below 1e7 N/m / what the equation of the same law gives\n");
  std::printf("%8s %6s | %9s | %11s %11s %11s | %11s %11s\n", "k [N/m]", "e", "law/e^2h", "h = 1e-4", "1e-3",
              "1e-2", "tol. 1e-6", "1e-8");
  for (const double k : {1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e12})
    for (const double e : {1., .8, .5, .1}) {
      const scene::Limits limits{.lower = -fall, .upper = 100, .stiffness = k, .restitution = e};
      const double law = std::pow(exit_rate(k, damping_of(e) / v, v), 2) / (2 * g);
      const double expected = k < 1e7 ? law : e * e * fall;
      std::printf("%8.0e %6.2f | %9.5f |", k, e, law / (e * e * fall));
      for (const Method& method :
           {Method{1e-4, {}}, Method{1e-3, {}}, Method{1e-2, {}}, Method{{}, 1e-6}, Method{{}, 1e-8}}) {
        const double height = rebound(limits, method);
        std::printf(" %11.7f%s", expected > 0 ? height / expected : height, method.step == 1e-2 ? " |" : "");
        EXPECT_LE(height, fall * (1 + 1e-9));
        EXPECT_NEAR(height, expected, .01 * expected);
      }
      std::printf("\n");
    }
}

TEST(StopRebound, DoesNotDependOnTheMethodsDamping) {
  for (const double rho : {0., .5, 1.})
    for (const double k : {1e4, 1e8, 1e12})
      for (const Method& method : {Method{1e-2, {}, rho}, Method{{}, 1e-8, rho}}) {
        const double height = rebound({.lower = -fall, .upper = 100, .stiffness = k}, method);
        std::printf("rho_inf %.1f, %.0e N/m, %s: %.9f\n", rho, k,
                    method.step ? "step 0.01 s" : "tolerance 1e-8", height / fall);
        EXPECT_LE(height, fall * (1 + 1e-9));
        EXPECT_GT(height, .99 * fall);
      }
}

// With damping in place of a restitution the same law.
TEST(StopRebound, FollowsTheDampingThatIsGiven) {
  const double v = std::sqrt(2 * g * fall);
  for (const double c : {.05, .5, 5.})
    for (const double k : {1e4, 1e8, 1e12}) {
      const double expected = std::pow(exit_rate(k, c, v), 2) / (2 * g);
      for (const Method& method : {Method{1e-2, {}}, Method{{}, 1e-8}}) {
        const double height = rebound({.lower = -fall, .upper = 100, .stiffness = k, .damping = c}, method);
        std::printf("c = %.2f s/m, %.0e N/m, %s: %.9f of the law's %.6f m\n", c, k,
                    method.step ? "step 0.01 s" : "tolerance 1e-8", expected > 0 ? height / expected : height,
                    expected);
        EXPECT_NEAR(height, expected, .01 * expected);
      }
    }
}

// A force on a body that rests on its stop grows within D and ends: what the stop has stored comes back. With
// m = 1 and the rate c of the force, d = c (t - sin(w t) / w) / k.
TEST(Stops, GiveBackWhatALoadStored) {
  const double k = 1e4, w = 100, F = 100;
  for (const double D : {0.1, 0.03, 0.003})
    for (const double tolerance : {1e-6, 1e-8}) {
      scene::Scene scene = machines::empty({0, 0, 0});
      const BodyId body = machines::add_body(scene, "b", 1, {.1, .1, .1}, {0, 0, 0});
      scene::Joint& joint =
          machines::add_joint(scene, "j", scene::JointType::prismatic, ground, body, {0, 0, 0});
      joint.limits = scene::Limits{};
      joint.limits->lower = 0, joint.limits->upper = 10, joint.limits->stiffness = k;
      scene::TableMotion force;
      force.times = {0, D, D + 1e-7}, force.values = {0, -F, 0};
      force.interpolation = scene::Interpolation::linear;
      force.smoothing = 1e-8;
      scene.mbd->forces.push_back(scene::Actuator{"f", JointId{0}, force});
      scene.coupling.window = window_s;
      scene.mbd->integrator.error_tolerance = tolerance;
      MbdSolver solver;
      solver.configure(scene);
      for (std::uint64_t n = 0; n < 30; ++n) advance(solver, n);
      const double c = F / D, d = c / k * (D - std::sin(w * D) / w), v = c / k * (1 - std::cos(w * D)),
                   expected = std::hypot(w * d, v);
      std::printf("  force for %g s, tolerance %.0e: expected %.5f m/s, measured %.5f, tolerance %.0e\n", D,
                  tolerance, expected, solver.state().u[0], 5e-3 * expected);
      EXPECT_NEAR(solver.state().u[0], expected, 5e-3 * expected);
    }
}

}  // namespace stops_test
}  // namespace tandem::mbd
