// The error that the summary states against the true one, which the extrapolated run of the same step tells.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace error_estimate_test {

using Json = nlohmann::json;
using machines::WholeRun;
using machines::with_step;

// Much longer steps end near the right place by chance: 4 and 2 steps per period, after 20 periods. The error
// of phase is 20 pi (omega h)^2 / 6 in all.
TEST(ErrorEstimate, OfAVibrationIsNotLuck) {
  for (const int steps : {80, 150}) {
    const double frequency = 10, amplitude = 5e-3, omega = 2 * std::numbers::pi * frequency;
    scene::Scene scene = machines::empty({0, 0, 0});
    const BodyId body = machines::add_body(scene, "b", 1, {.1, .1, .1}, {1, 0, 0});
    machines::add_joint(scene, "j", scene::JointType::prismatic, ground, body, {1, 0, 0}, {1, 0, 0}).rate =
        amplitude * omega;
    scene::SpringDamper spring;
    spring.name = "s", spring.body_b = body;
    spring.point_a = {0, 0, 0}, spring.point_b = {1, 0, 0};
    spring.length = 1, spring.stiffness = omega * omega;
    scene.mbd->forces.push_back(spring);
    scene.coupling.window = 0.025;
    scene.mbd->integrator.step = 1 / frequency / steps;
    scene.end_time = 2;
    WholeRun run(scene);
    const double error = std::abs(run.solver.observe().bodies[0].pose.p_WB.x - 1) / (2 * amplitude);
    const double says = run.facts()["mbd_position_error_estimate"].get<double>();
    std::printf("  %d steps per period: off by %.3g of the way, says %.3g\n", steps, error, says);
    EXPECT_GT(says, error / 2);
    EXPECT_LT(says, error * 3);
  }
}

TEST(ErrorEstimate, IsNearTheTrueError) {
  std::printf("%-22s %9s %10s %10s %10s %10s %10s %10s %8s %8s\n", "scene", "step [s]", "true [m]",
              "estimate", "true [rad]", "estimate", "true [J]", "estimate", "steps", "time");
  int estimated = 0;
  const auto text = [](const Json& value) {
    return value.is_number() ? fmt::format("{:10.2e}", value.get<double>()) : "      none";
  };
  for (const char* name : {"simple_pendulum", "simple_pendulum_cut", "four_bars", "bricard", "governor",
                           "heavy_top", "flipping_body", "squeezer", "mass_ratio", "gear_train", "engine"})
    for (const double factor : {1., 4.}) {
      const scene::Scene scene = with_step(name, factor);
      scene::Scene better = with_step(name, 1);
      better.mbd->integrator.extrapolate = true;
      WholeRun run(scene), exact(better);
      const protocol::BodiesFrame is = run.solver.observe(), should_be = exact.solver.observe();
      double position = 0, rotation = 0;
      for (std::size_t k = 0; k < is.bodies.size(); ++k) {
        const Pose &a = is.bodies[k].pose, &b = should_be.bodies[k].pose;
        position = std::max(position, norm(a.p_WB - b.p_WB));
        rotation = std::max(rotation, norm(rotation_vector(a.q_WB * b.q_WB.conjugate())));
      }
      const double energy = std::abs(is.energy - should_be.energy);
      const Json facts = run.facts();
      const Json &p = facts["mbd_position_error_estimate_m"], &r = facts["mbd_rotation_error_estimate_rad"],
                 &e = facts["mbd_energy_error_estimate_J"];
      const double steps = facts["mbd_error_estimate_steps"].get<double>() / facts["mbd_steps"].get<double>();
      std::printf("%-22s %9.2e %10.2e %s %10.2e %s %10.2e %s %6.1f %% %6.1f %%\n", name,
                  *scene.mbd->integrator.step, position, text(p).c_str(), rotation, text(r).c_str(), energy,
                  text(e).c_str(), 100 * steps,
                  100 * facts["mbd_error_estimate_cpu_seconds"].get<double>() /
                      facts["mbd_solver_cpu_seconds"].get<double>());
      EXPECT_LT(steps, .95) << name;
      const auto check = [&](const Json& estimate, double error, double round_off, const char* what) {
        if (estimate.is_string()) {
          EXPECT_EQ(estimate.get<std::string>().find("not estimated: "), 0u);
          return;
        }
        ++estimated;
        if (error < round_off) return;
        EXPECT_GT(estimate.get<double>(), error / 3) << name << " " << what;
        EXPECT_LT(estimate.get<double>(), error * 10) << name << " " << what;
      };
      check(p, position, 1e-9, "position");
      check(r, rotation, 1e-9, "rotation");
      check(e, energy, 1e-9 * std::max(1., std::abs(is.energy)), "energy");
    }
  EXPECT_GE(estimated, 64);
}

}  // namespace error_estimate_test
}  // namespace tandem::mbd
