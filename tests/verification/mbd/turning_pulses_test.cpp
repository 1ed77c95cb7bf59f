// Pulses of force that are much shorter than a step and move the machine within it: against a fine
// integration of a cart with a pendulum, and the energy that they give.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "common/scene/motion_function.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace turning_pulses_test {

using scene::Interpolation;
using scene::JointType;
using scene::MotionFunction;
using scene::TableMotion;

constexpr double cart = 2, mass = 1, inertia = .02, length = .5, start = .1003, end = 1;
constexpr double about_hinge = inertia + mass * length * length;

// A cart on a slide and a pendulum on it, in sizes of L; a torque turns the pendulum against the cart.
scene::Scene hammer(const TableMotion& torque, double L) {
  scene::Scene scene = machines::empty({0, 0, -9.81 * L});
  const double I = L * L;
  const BodyId a = machines::add_body(scene, "a", cart, {I, I, I}, {0, 0, 0});
  const BodyId b =
      machines::add_body(scene, "b", mass, {inertia * I, inertia * I, inertia * I}, {0, 0, -length * L});
  machines::add_joint(scene, "d", JointType::prismatic, ground, a, {0, 0, 0}, {1, 0, 0});
  machines::add_joint(scene, "j", JointType::revolute, a, b, {0, 0, 0}, {0, 1, 0});
  TableMotion scaled = torque;
  for (double& value : scaled.values) value *= I;
  scene.mbd->forces.push_back(scene::Actuator{"f", JointId{1}, scaled});
  return scene;
}

struct Swing {
  double angle = 0, rate = 0, travel = 0, speed = 0, widest = 0;
};

// (M + m) x'' - m l (q'' cos q - q'^2 sin q) = 0,  (I + m l^2) q'' - m l x'' cos q + m g l sin q = torque, by
// the classical Runge-Kutta method in parts that end at the breaks of the torque.
Swing swing(const TableMotion& torque) {
  const MotionFunction of_time(torque, scene::FunctionOf::force);
  Swing s;
  const auto rate = [&](double tau, const Swing& at) {
    const double c = std::cos(at.angle), sine = std::sin(at.angle), ml = mass * length, M = cart + mass;
    const double f = -ml * at.rate * at.rate * sine, t = tau - ml * 9.81 * sine;
    const double det = M * about_hinge - ml * ml * c * c;
    return Swing{at.rate, (M * t + ml * c * f) / det, at.speed, (about_hinge * f + ml * c * t) / det};
  };
  std::vector<double> marks{0};
  for (const double t : of_time.samples(0, end)) marks.push_back(t);
  marks.push_back(end);
  for (std::size_t i = 0; i + 1 < marks.size(); ++i) {
    const double from = marks[i], whole = marks[i + 1] - from;
    if (whole <= 0) continue;
    const int n = std::max(1, static_cast<int>(std::ceil(whole / 2e-4)));
    const double h = whole / n;
    for (int k = 0; k < n; ++k) {
      const auto tau = [&](double t) {
        return of_time.at(std::clamp(from + t, from + 1e-9 * whole, from + whole * (1 - 1e-9))).value;
      };
      const auto at = [&](const Swing& d, double w) {
        return Swing{s.angle + w * d.angle, s.rate + w * d.rate, s.travel + w * d.travel,
                     s.speed + w * d.speed};
      };
      const Swing k1 = rate(tau(k * h), s), k2 = rate(tau((k + .5) * h), at(k1, h / 2)),
                  k3 = rate(tau((k + .5) * h), at(k2, h / 2)), k4 = rate(tau((k + 1) * h), at(k3, h));
      s.angle += h / 6 * (k1.angle + 2 * k2.angle + 2 * k3.angle + k4.angle);
      s.rate += h / 6 * (k1.rate + 2 * k2.rate + 2 * k3.rate + k4.rate);
      s.travel += h / 6 * (k1.travel + 2 * k2.travel + 2 * k3.travel + k4.travel);
      s.speed += h / 6 * (k1.speed + 2 * k2.speed + 2 * k3.speed + k4.speed);
      s.widest = std::max(s.widest, std::abs(s.angle));
    }
  }
  return s;
}

// Two equal torques of the width D / 2 after each other, of opposite signs, that turn the free pendulum by
// about `turn` and leave it at rest.
TableMotion pulse(Interpolation interpolation, double D, double turn) {
  const double peak = turn * about_hinge / (D * D / 4);
  if (interpolation == Interpolation::step)
    return {{0, start, start + D / 2, start + D}, {0, peak, -peak, 0}, interpolation};
  return {
      {0, start, start + D / 4, start + 3 * D / 4, start + D}, {0, 0, 2 * peak, -2 * peak, 0}, interpolation};
}

TEST(TurningPulses, LeaveTheMachineAsAFineIntegrationDoes) {
  for (const Interpolation interpolation :
       {Interpolation::step, Interpolation::linear, Interpolation::monotone})
    for (const double turn : {1e-3, .02, .05, .3})
      for (const double D : {1e-2, 2e-3, 1e-4})
        for (const double L : {.01, 1.})
          for (const double step : {1e-2, 1e-3, 1e-4}) {
            if ((L != 1 || step == 1e-4) && (D != 2e-3 || (L != 1 && step != 1e-2))) continue;
            if (turn > 200 * D) continue;  // at more than a hundred turns in a second
            for (const auto& [extrapolate, rho_inf] :
                 {std::pair{false, .8}, std::pair{true, .8}, std::pair{false, 0.}}) {
              const TableMotion torque = pulse(interpolation, D, turn);
              scene::Scene scene = hammer(torque, L);
              scene.coupling.window = step;
              scene.end_time = end;
              scene.mbd->integrator.extrapolate = extrapolate;
              scene.mbd->integrator.rho_inf = rho_inf;
              machines::WholeRun run(scene);
              const Swing exact = swing(torque);
              const auto& joint = run.solver.observe().joints[1];
              const double error =
                  std::max(std::abs(joint.q - exact.angle), std::abs(joint.rate - exact.rate) / 5);
              // The swing itself is of second order.
              const double allowed = (.02 + 50 * step * step) * exact.widest;
              const nlohmann::json facts = run.facts();
              const auto& estimate = facts["mbd_position_error_estimate"];
              const double says =
                  estimate.is_number() ? estimate.get<double>() : facts["mbd_local_error_sum"].get<double>();
              std::printf(
                  "table %d, turn %.3f in %g s, %g m, step %g s, rho_inf %g%s: angle %.6f, expected %.6f, "
                  "rate %.5f, "
                  "expected %.5f; error %.1e, tolerance %.1e, stated %.1e, %d steps\n",
                  static_cast<int>(interpolation), turn, D, L, step, rho_inf,
                  extrapolate ? ", extrapolated" : "", joint.q, exact.angle, joint.rate, exact.rate, error,
                  allowed, says, static_cast<int>(run.solver.state().steps));
              EXPECT_TRUE(error < allowed || says > .01);
              // With the rate after half a second as a distance.
              EXPECT_TRUE(error < std::max(1e-6, 3 * says * exact.widest) || says > .01);
            }
          }
}

// 2 kg on a slide under a force that rises and falls within a step: it is exact, and so is its balance.
TEST(TurningPulses, OfForcesAreBalanced) {
  for (const double D : {1e-2, 1e-4, 1e-6})
    for (const double share : {.2, .6, 1., 100.})
      for (const bool on_body : {false, true}) {
        const double step = std::max(1e-4, std::round(share * D * 1e6) / 1e6), peak = 20 / D;
        scene::Scene scene = machines::empty({0, 0, 0});
        const BodyId b = machines::add_body(scene, "b", 2, {.1, .1, .1}, {0, 0, 0});
        machines::add_joint(scene, "j", JointType::prismatic, ground, b, {0, 0, 0}, {1, 0, 0});
        const TableMotion force{
            {0, start, start + D / 2, start + D, 1}, {0, 0, peak, 0, 0}, Interpolation::linear};
        if (on_body) {
          scene::BodyLoad load;
          load.name = "f", load.body = b, load.direction = {1, 0, 0}, load.size = force;
          scene.mbd->forces.push_back(load);
        } else {
          scene.mbd->forces.push_back(scene::Actuator{"a", JointId{0}, force});
        }
        scene.coupling.window = step;
        scene.end_time = std::ceil(.3 / step) * step;
        machines::WholeRun run(scene);
        const nlohmann::json facts = run.facts();
        const double off = std::abs(facts["mbd_largest_energy_balance_J"].get<double>()) /
                           facts["mbd_energy_scale_J"].get<double>();
        std::printf(
            "pulse of %g s, step %g s, %s: %.12f, expected 5 m/s; %.1e of the energy is not accounted for, "
            "tolerance 5e-3\n",
            D, step, on_body ? "on the body" : "on the joint", run.solver.state().u[0], off);
        EXPECT_NEAR(run.solver.state().u[0], 5, 1e-9);
        EXPECT_LT(off, 5e-3);
      }
}

}  // namespace turning_pulses_test
}  // namespace tandem::mbd
