// Functions of time that are faster than the steps: what they do between two steps is not lost. Forces
// against their closed form, prescribed motions against a fine integration of the pendulum that they move.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "common/scene/motion_function.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace fast_functions_test {

using scene::FunctionOf;
using scene::Interpolation;
using scene::JointType;
using scene::MotionFunction;
using scene::MotionOf;
using scene::RampMotion;
using scene::TableMotion;

struct Setting {
  const char* name;
  std::optional<double> error_tolerance{};
  bool extrapolate = false;
  double rho_inf = .8;
};
const Setting settings[] = {{"fixed steps"},
                            {"rho_inf 0.3", {}, false, .3},
                            {"extrapolated", {}, true},
                            {"tolerance 1e-6", 1e-6},
                            {"tolerance 1e-7", 1e-7}};

scene::Scene set(scene::Scene scene, const Setting& setting, double step, double end) {
  scene.coupling.window = step;
  scene.end_time = std::ceil(end / step - 1e-9) * step;
  scene.mbd->integrator.error_tolerance = setting.error_tolerance;
  scene.mbd->integrator.extrapolate = setting.extrapolate;
  scene.mbd->integrator.rho_inf = setting.rho_inf;
  return scene;
}

double end_of(const scene::Scene& scene) {
  return std::round(scene.end_time / scene.coupling.window) * scene.coupling.window;
}

// A pendulum of length L and mass 1 kg, I = 0.01 L^2, under a carriage with a prescribed motion, in the
// gravity 9.81 L: its angle does not depend on L. A wheel elsewhere has nearly all of the energy.
scene::Scene carriage(const scene::Motion& motion, double L, bool flywheel = false) {
  scene::Scene scene = machines::empty({0, 0, -9.81 * L});
  const double I = L * L;
  const BodyId a = machines::add_body(scene, "a", 1, {.1 * I, .1 * I, .1 * I}, {0, 0, 0});
  const BodyId b = machines::add_body(scene, "b", 1, {.01 * I, .01 * I, .01 * I}, {0, 0, -L});
  machines::add_joint(scene, "d", JointType::prismatic, ground, a, {0, 0, 0}, {1, 0, 0}).motion = motion;
  machines::add_joint(scene, "j", JointType::revolute, a, b, {0, 0, 0}, {0, 1, 0});
  if (flywheel) {
    const BodyId fly = machines::add_body(scene, "fly", 10, {.2 * I, .2 * I, .2 * I}, {0, L, 0});
    machines::add_joint(scene, "f", JointType::revolute, ground, fly, {0, L, 0}, {0, 0, 1}).rate = 100;
  }
  return scene;
}

struct Swing {
  double angle = 0, rate = 0;
  double size = 0;  // of all impulses, over the mass
};

// 1.01 w' = x'' cos(angle) - 9.81 sin(angle), with x'' of the motion over L, by the classical Runge-Kutta
// method, in parts that end at the breaks of the motion.
Swing swing(const MotionFunction& motion, double L, double end) {
  std::vector<double> marks{0};
  for (const double t : motion.samples(0, end)) marks.push_back(t);
  marks.push_back(end);
  Swing s;
  for (std::size_t i = 0; i + 1 < marks.size(); ++i) {
    for (const MotionFunction::RateJump& jump : motion.rate_jumps())
      if (jump.time == marks[i] && jump.time > 0)
        s.rate += (jump.after - jump.before) / L * std::cos(s.angle) / 1.01;
    const double length = marks[i + 1] - marks[i];
    if (length <= 0) continue;
    const int n = std::max(8, static_cast<int>(std::ceil(length / 2e-4)));
    const double h = length / n;
    const auto f = [&](double t, const Swing& at) {
      // The limit from the inside of the part.
      const double inside = std::clamp(t, marks[i] + 1e-9 * length, marks[i + 1] - 1e-9 * length);
      return Swing{
          at.rate,
          (motion.at(inside).acceleration / L * std::cos(at.angle) - 9.81 * std::sin(at.angle)) / 1.01};
    };
    for (int k = 0; k < n; ++k) {
      const double t = marks[i] + k * h;
      const auto at = [&](const Swing& d, double w) {
        return Swing{s.angle + w * d.angle, s.rate + w * d.rate};
      };
      const Swing k1 = f(t, s), k2 = f(t + h / 2, at(k1, h / 2)), k3 = f(t + h / 2, at(k2, h / 2)),
                  k4 = f(t + h, at(k3, h));
      s.angle += h / 6 * (k1.angle + 2 * k2.angle + 2 * k3.angle + k4.angle);
      s.rate += h / 6 * (k1.rate + 2 * k2.rate + 2 * k3.rate + k4.rate);
    }
  }
  return s;
}

// `tolerance`: of the angle and of the rate over sqrt(9.81 / 1.01), beside that of the free swing, which the
// step does not resolve exactly.
void expect_swing(const char* what, const std::function<scene::Motion(double)>& motion, double interval,
                  double tolerance, bool flywheel = false) {
  for (const double share : {.2, 1., 5.})
    for (const double L : {.01, 1., 100.})
      for (const Setting& setting : settings) {
        if (L != 1 && setting.rho_inf != .8) continue;
        const double step = share * interval;
        const scene::Scene scene = set(carriage(motion(L), L, flywheel), setting, step, .6);
        machines::WholeRun run(scene);
        const Swing exact = swing(MotionFunction(motion(L)), L, end_of(scene));
        const auto& joint = run.solver.observe().joints[1];
        const double q = joint.q, dq = q - exact.angle,
                     dw = (joint.rate - exact.rate) / std::sqrt(9.81 / 1.01);
        const double most = std::max(std::abs(dq), std::abs(dw));
        // Second order of the swing itself: (w h)^2 / 12, times its angle of w t.
        const double w_h = std::sqrt(9.81 / 1.01) * step,
                     allowed = tolerance + w_h * w_h / 2 +
                               (setting.error_tolerance ? 5e-4 + 2e3 * *setting.error_tolerance : 0);
        std::printf(
            "%s, step %.1f of %g s, %g m, %s: angle %.6f, expected %.6f; error %.1e, tolerance %.1e\n", what,
            share, interval, L, setting.name, q, exact.angle, most, allowed);
        EXPECT_LT(most, allowed);
      }
}

TEST(FastFunctions, RampOfACarriageSwingsItsPendulum) {
  expect_swing(
      "ramp",
      [](double L) {
        return RampMotion{0, .2 * L, .1, .005};
      },
      .005, 2e-4);
}

TEST(FastFunctions, RampOfACarriageFasterThanAnyStep) {
  expect_swing(
      "fast ramp",
      [](double L) {
        return RampMotion{0, .002 * L, .1037, 1e-5};
      },
      .005, 2e-4);
}

// The motion that a short ramp leaves behind is small beside 1 rad, by which error control judges it.
TEST(FastFunctions, SmallRampsOfACarriageUnderErrorControl) {
  for (const MotionOf of : {MotionOf::position, MotionOf::speed})
    for (const double to : {1e-4, 1e-3})
      for (const double D : {1e-9, 1e-6, 1e-5, 1e-4, 1e-3})
        for (const double step : {5e-4, 1e-2})
          for (const double tolerance : {1e-6, 1e-8}) {
            if (D < 1e-6 && of == MotionOf::position) continue;  // refused
            const RampMotion ramp{0, to, .1037, D, of};
            const scene::Scene scene = set(carriage(ramp, 1), {"", tolerance}, step, 1);
            machines::WholeRun run(scene);
            const Swing exact = swing(MotionFunction(ramp), 1, end_of(scene));
            const auto& joint = run.solver.observe().joints[1];
            const double amplitude = std::hypot(exact.angle, exact.rate / std::sqrt(9.81 / 1.01)),
                         error = std::hypot(joint.q - exact.angle,
                                            (joint.rate - exact.rate) / std::sqrt(9.81 / 1.01));
            const nlohmann::json facts = run.facts();
            const nlohmann::json& estimate = facts["mbd_position_error_estimate"];
            const double says = estimate.is_number() ? estimate.get<double>() : 0;
            std::printf(
                "%s by %g within %g s, window %g s, tolerance %g: angle %.8f, expected %.8f; off by %.1e of "
                "the swing, says %.1e; %d steps\n",
                of == MotionOf::speed ? "speed" : "ramp", to, D, step, tolerance, joint.q, exact.angle,
                error / amplitude, says, static_cast<int>(run.solver.state().steps));
            EXPECT_TRUE(error < 0.02 * amplitude || says > 0.01);
          }
}

TEST(FastFunctions, RampOfASpeedSwingsItsPendulum) {
  expect_swing(
      "speed ramp",
      [](double L) {
        return RampMotion{0, 1. * L, .1, .001, MotionOf::speed};
      },
      .002, 5e-4, true);
}

TEST(FastFunctions, TablesOfACarriageSwingItsPendulum) {
  for (const Interpolation i :
       {Interpolation::linear, Interpolation::monotone, Interpolation::spline, Interpolation::step}) {
    const auto table = [&](double L) {
      // A spline overshoots so far that the pendulum would turn over.
      const double s = i == Interpolation::spline ? .005 * L : L;
      TableMotion m{{0, .1003, .1053, .1203, .1213, .4}, {0, 0, .1 * s, .1 * s, .12 * s, .12 * s}, i};
      m.smoothing = 1e-3;
      return m;
    };
    expect_swing(("table " + std::to_string(int(i))).c_str(), table, .005, 5e-4);
  }
}

// 2 kg on a slide.
scene::Scene pushed(const scene::Motion& force) {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId b = machines::add_body(scene, "b", 2, {.1, .1, .1}, {0, 0, 0});
  machines::add_joint(scene, "j", JointType::prismatic, ground, b, {0, 0, 0}, {1, 0, 0});
  scene.mbd->forces.push_back(scene::Actuator{"a", JointId{0}, force});
  return scene;
}

// Impulse and its first moment about the end by 5-point Gauss integration between the knots.
Swing moved(const MotionFunction& force, double end, double mass) {
  constexpr double x[] = {0, .5384693101056831, .9061798459386640};
  constexpr double w[] = {.5688888888888889, .4786286704993665, .2369268850561891};
  const std::vector<double> marks = force.samples(0, end);
  Swing s;
  for (std::size_t i = 0; i + 1 < marks.size(); ++i) {
    const double half = (marks[i + 1] - marks[i]) / 2, middle = marks[i] + half;
    for (int k = -2; k <= 2; ++k) {
      const double t = middle + std::copysign(x[std::abs(k)], k) * half, f = force.at(t).value;
      s.rate += w[std::abs(k)] * half * f / mass;
      s.size += w[std::abs(k)] * half * std::abs(f) / mass;
      s.angle += w[std::abs(k)] * half * f / mass * (end - t);
    }
  }
  return s;
}

void expect_impulse(const char* what, const scene::Motion& force, double interval, bool smooth) {
  for (const double share : {.2, 1., 5., 100.})
    for (const Setting& setting : settings) {
      const double step = share * interval;
      const scene::Scene scene = set(pushed(force), setting, step, 1);
      machines::WholeRun run(scene);
      const Swing exact = moved(MotionFunction(force, FunctionOf::force), end_of(scene), 2);
      const double v = run.solver.state().u[0];
      std::printf("%s, step %.1f of %g s, %s: %.9f, expected %.9f m/s, error %.1e\n", what, share, interval,
                  setting.name, v, exact.rate, v - exact.rate);
      // Steps that are shorter than a 64th of a smooth interval see it by its values: second order.
      const double allowed = (setting.error_tolerance ? 5e-5 : smooth ? 1e-3 : 1e-12) * exact.size;
      EXPECT_NEAR(v, exact.rate, allowed) << what;
    }
}

TEST(FastFunctions, PulsesOfForceGiveTheirImpulse) {
  for (const Interpolation i :
       {Interpolation::linear, Interpolation::monotone, Interpolation::spline, Interpolation::step})
    for (const double width : {1e-6, 1e-4, .01}) {
      const double T = width, t = .1003;
      expect_impulse(("pulse " + std::to_string(int(i))).c_str(),
                     TableMotion{{0, t, t + T, t + 2 * T, t + 3 * T, .5, .9}, {0, 0, 50, 70, 0, -20, 0}, i},
                     std::max(T, 1e-3), i == Interpolation::monotone || i == Interpolation::spline);
    }
}

TEST(FastFunctions, RampsOfForceGiveTheirImpulse) {
  for (const double width : {1e-6, 1e-4, .01})
    expect_impulse("ramp of a force", RampMotion{0, 50, .1003, width}, std::max(width, 1e-3), false);
}

// 9 % of the range of the table, and of far shorter duration than a step.
TEST(FastFunctions, SmallPulsesBesideLargeChangesGiveTheirImpulse) {
  for (const Interpolation i : {Interpolation::monotone, Interpolation::spline})
    expect_impulse("small pulse",
                   TableMotion{{0, .1003, .1008, .1013, .4, .7, .9}, {0, 0, 9, 0, 0, 100, 100}, i}, .001,
                   true);
}

}  // namespace fast_functions_test
}  // namespace tandem::mbd
