// Changes that steps used to pass over: narrow forces over a coordinate, unstable equilibria near the start,
// and errors of motions that are small beside the machine.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "mbd_server/model/periodic_curve.hpp"
#include "mbd_server/solve/equilibrium.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace unseen_changes_test {

using scene::JointType;

void compare(const std::string& what, double measured, double expected, double tolerance) {
  std::printf("%-52s expected %.10g measured %.10g relative error %.2e tolerance %.0e\n", what.c_str(),
              expected, measured, std::abs(measured / expected - 1), tolerance);
  EXPECT_NEAR(measured / expected, 1, tolerance) << what;
}

// A bead of 1 kg at 10 m/s meets a force of 7500 N against it over 2 `width` of its way: its energy is what
// the force leaves of it.
double speed_after(double width, const std::function<void(scene::Scene&)>& change) {
  scene::Scene scene = machines::bead(1, 10);
  const double peak = -15 / width;
  scene.mbd->forces.push_back(scene::Actuator{
      "spike", JointId{0}, scene::ConstantMotion{}, "",
      scene::JointFunction{
          JointId{0}, false, {{-1, .3, .3 + width, .3 + 2 * width, 10}, {0, 0, peak, 0, 0}}, {}}});
  scene.coupling.window = 1e-3;
  scene.end_time = .1;
  change(scene);
  machines::WholeRun run(scene);
  return run.solver.state().u[0];
}

TEST(NarrowForce, TakesItsWorkFromABead) {
  for (const double width : {1e-5, 1e-3, 2e-3, 1e-2}) {
    const PeriodicCurve curve({-1, .3, .3 + width, .3 + 2 * width, 10}, {0, 0, -15 / width, 0, 0}, {},
                              PeriodicCurve::Smoothness::slope);
    double work = 0;
    constexpr int parts = 2000;
    for (int k = 0; k < parts; ++k)
      work += curve.at(.3 + (k + .5) * 2 * width / parts).value * 2 * width / parts;
    const double exact = std::sqrt(100 + 2 * work);
    for (const double tolerance : {1e-6, 1e-8}) {
      compare("speed after a narrow force, error control [m/s]",
              speed_after(width, [&](scene::Scene& s) { s.mbd->integrator.error_tolerance = tolerance; }),
              exact, 2e-3);
    }
    compare("the same, explicit method [m/s]",
            speed_after(width,
                        [&](scene::Scene& s) {
                          s.mbd->integrator.method = scene::IntegrationMethod::dormand_prince;
                          s.mbd->integrator.error_tolerance = 1e-8;
                        }),
            exact, 1e-3);
    compare("the same, fixed steps in parts [m/s]", speed_after(width, [](scene::Scene&) {}), exact, 5e-2);
  }
}

// 19.62 sin(x) = 15 x: upright it is unstable, and from the smallest angle on it falls to that side.
TEST(UnstableEquilibrium, IsLeftDownhill) {
  double stable = 1.2;
  for (int i = 0; i < 50; ++i)
    stable -= (19.62 * std::sin(stable) - 15 * stable) / (19.62 * std::cos(stable) - 15);
  for (const double L : {.01, 1., 100.})
    for (const double angle : {1e-6, .01, .06, -.3, .9, 1.5, 2.}) {
      scene::Scene scene = machines::empty({0, 0, -9.81 / L});
      const BodyId b = machines::add_body(scene, "b", 2, {.01 * L * L, .01 * L * L, .01 * L * L},
                                          {L * std::sin(angle), 0, L * std::cos(angle)});
      machines::add_joint(scene, "j", JointType::revolute, ground, b, {0, 0, 0}, {0, 1, 0});
      scene::RotationalSpringDamper spring;
      spring.name = "k", spring.joint = JointId{0}, spring.stiffness = 15, spring.angle = -angle;
      scene.mbd->forces.push_back(spring);
      machines::Run run(scene, 1e-2);
      find_equilibrium(run.model, run.system, run.state);
      compare("angle of the equilibrium [rad]", run.state.q[0] + angle, std::copysign(stable, angle), 1e-9);
    }
}

TEST(UnstableEquilibrium, IsNamedInTheSummary) {
  scene::Scene scene = machines::empty();
  const BodyId b = machines::add_body(scene, "b", 2, {.01, .01, .01}, {0, 0, 1});
  machines::add_joint(scene, "j", JointType::revolute, ground, b, {0, 0, 0}, {0, 1, 0});
  scene.mbd->start = scene::Start::equilibrium;
  scene.end_time = .1;
  scene.coupling.window = .01;
  machines::WholeRun run(scene);
  const nlohmann::json facts = run.facts();
  ASSERT_EQ(facts["warnings"].size(), 1U);
  EXPECT_NE(facts["warnings"][0].get<std::string>().find("unstable"), std::string::npos);
}

struct Vibration {
  double amplitude = 0, omega = 0;  // [m or rad], [rad/s]
  double stated = 0, error = 0;     // of how far it moves
};

// Runs `periods` and a quarter with n steps in each. The coordinate is that of the first joint.
Vibration vibrate(scene::Scene scene, double amplitude, double omega, int n, double periods) {
  scene.coupling.window = 2 * std::numbers::pi / omega / n;
  scene.end_time = std::round((periods + .25) * n) * scene.coupling.window;
  scene.mbd->joints[0].rate = amplitude * omega;
  machines::WholeRun run(scene);
  const double x = run.solver.state().q[0], t = run.solver.state().time;
  const nlohmann::json facts = run.facts();
  const auto& estimate = facts["mbd_position_error_estimate"];
  return {amplitude, omega,
          estimate.is_number() ? estimate.get<double>() : facts["mbd_local_error_sum"].get<double>(),
          std::abs(x - amplitude * std::sin(omega * t)) / (2 * amplitude)};
}

void add_flywheel(scene::Scene& scene, double distance) {
  const BodyId fly = machines::add_body(scene, "fly", 1000, {500, 500, 500}, {distance, 0, 0});
  machines::add_joint(scene, "f", JointType::revolute, ground, fly, {distance, 0, 0}, {0, 0, 1}).rate = 1;
}

// The stated error is at least a third of the true one, relative to the amplitude, or more than a hundredth.
void expect_stated(const char* what, const Vibration& v, int n) {
  std::printf("%s, amplitude %g, %d steps in a period: error %.2e of the motion, stated %.2e\n", what,
              v.amplitude, n, v.error, v.stated);
  EXPECT_TRUE(v.stated > 0.01 || v.error < 3 * v.stated);
}

// A vibration in a machine of 1 m, alone and beside another machine that is far away and turns.
TEST(SmallMotions, AreJudgedByWhatTheyDo) {
  for (const double beside : {0., 10., 100., 1000.})
    for (const double amplitude : {5e-4, 5e-3, 5e-2})
      for (const int n : {24, 60, 200, 1000}) {
        if (beside > 0 && n > 60) continue;
        const double omega = 20 * std::numbers::pi;
        scene::Scene scene = machines::empty({0, 0, 0});
        const BodyId b = machines::add_body(scene, "b", 1, {.1, .1, .1}, {1, 0, 0});
        machines::add_joint(scene, "j", JointType::prismatic, ground, b, {1, 0, 0}, {1, 0, 0});
        scene::SpringDamper spring;
        spring.name = "s", spring.body_b = b, spring.point_b = {1, 0, 0}, spring.length = 1;
        spring.stiffness = omega * omega;
        scene.mbd->forces.push_back(spring);
        if (beside > 0) add_flywheel(scene, beside);
        expect_stated(beside > 0 ? "beside another machine" : "alone",
                      vibrate(scene, amplitude, omega, n, 50), n);
      }
}

TEST(SmallMotions, OfTorsionAreJudgedByWhatTheyDo) {
  for (const double amplitude : {1e-5, 1e-4, 1e-2})
    for (const int n : {24, 60}) {
      const double omega = 100, inertia = .1;
      scene::Scene scene = machines::empty({0, 0, 0});
      const BodyId b = machines::add_body(scene, "t", 1, {inertia, inertia, inertia}, {0, 0, 0});
      machines::add_joint(scene, "j", JointType::revolute, ground, b, {0, 0, 0}, {0, 0, 1});
      scene::RotationalSpringDamper spring;
      spring.name = "k", spring.joint = JointId{0}, spring.stiffness = inertia * omega * omega;
      scene.mbd->forces.push_back(spring);
      add_flywheel(scene, 1);
      expect_stated("torsion", vibrate(scene, amplitude, omega, n, 30), n);
    }
}

}  // namespace unseen_changes_test
}  // namespace tandem::mbd
