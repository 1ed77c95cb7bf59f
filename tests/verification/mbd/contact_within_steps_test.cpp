// Contacts that begin and end within steps: what rebounds, slides and rests does as it does where each step
// ends at a contact, to an error that falls with the step and that error control bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace contact_within_steps_test {

using namespace contacts;

ContactScene scene_within_steps(std::optional<double> tolerance) {
  ContactScene s;
  s.add_floor();
  s.scene.contact->impacts = scene::Impacts::within_steps;
  s.scene.mbd->integrator.error_tolerance = tolerance;
  return s;
}

// Rate after an impact over the rate before, of a ball of 1 kg that falls onto 1e5 N/m: 10 ms of contact.
double rebound(double restitution, double step, std::optional<double> tolerance) {
  ContactScene s = scene_within_steps(tolerance);
  s.material() = {"stuff", 1e5, 0, 0, restitution, 0};
  const BodyId ball = s.add_ball("ball", 1, 0.1, {0, 0, 0.1 + 0.01});
  s.body(ball).twist.v_WB = {0, 0, -2};
  ContactRun run(s.scene, step);
  run.advance(static_cast<int>(std::lround(0.03 / step)));
  // To the height at which the contact began.
  const double in = std::sqrt(4 + 2 * g * 0.01), v = run.velocity().z, z = run.position().z - 0.1;
  return std::sqrt(v * v + 2 * g * z) / in;
}

// The law of the material, as it is where each step ends at the contact.
TEST(ContactWithinSteps, ABallReboundsByItsRestitution) {
  for (const double e : {0.9, 0.5, 0.2})
    for (const double tolerance : {1e-5, 1e-6}) {
      std::printf("  restitution %.1f, error tolerance %.0e\n", e, tolerance);
      expect_near("rate after over rate before", rebound(e, 2e-3, tolerance), e,
                  tolerance > 2e-6 ? 0.01 : 0.003);
    }
}

TEST(ContactWithinSteps, TheErrorFallsWithTheSquareOfAFixedStep) {
  const double exact = rebound(0.5, 1e-5, {});
  double last = 0;
  for (const double step : {1e-3, 5e-4, 2.5e-4}) {
    const double error = std::abs(rebound(0.5, step, {}) - exact);
    std::printf("  step %.2g s: error of the rebound %.2e\n", step, error);
    EXPECT_LT(error, 4e4 * step * step);
    if (last > 0) EXPECT_LT(error, 0.5 * last);
    last = error;
  }
}

// v^2 / (2 mu g), and then rest.
TEST(ContactWithinSteps, ABoxSlidesItsWayAndRests) {
  ContactScene s = scene_within_steps(1e-6);
  s.material() = {"stuff", 1e5, 0, 0, 0.2, 0.4};
  const BodyId box = s.add_box("box", 2, {0.2, 0.2, 0.1}, {0, 0, 0.05 - 2 * g / 4e5});
  s.body(box).twist.v_WB = {1, 0, 0};
  ContactRun run(s.scene, 1e-2);
  run.advance(60);
  expect_near("way of the box [m]", run.position().x, 1 / (2 * 0.4 * g), 1e-3);
  const Vec3d there = run.position();
  run.advance(200);
  expect_near("way in 2 s of rest [m]", norm(run.position() - there), 0, 1e-8);
  const auto facts = run.facts();
  expect_near("energy unaccounted for, of that which moves",
              std::abs(facts["mbd_largest_energy_balance_J"].get<double>()) /
                  facts["mbd_energy_scale_J"].get<double>(),
              0, 0.01);
}

// Each as deep in the one below as the weight above asks for.
TEST(ContactWithinSteps, BoxesThatFallOnEachOtherRestOnEachOther) {
  ContactScene s = scene_within_steps(1e-5);
  s.material() = {"stuff", 1e5, 0, 0, 0.1, 0.5};
  for (int i = 0; i < 4; ++i)
    s.add_box("box" + std::to_string(i), 1, {0.2, 0.3, 0.1}, {0, 0, 0.05 + 0.12 * i});
  ContactRun run(s.scene, 1e-2);
  run.advance(200);
  double height = 0.05, worst = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    height -= static_cast<double>(4 - i) * g / 4e5;
    worst = std::max(worst, std::abs(run.position(i).z - height));
    height += 0.1;
  }
  expect_near("largest error of the four heights [m]", worst, 0, 1e-7);
  expect_energy(run, 0.01);
}

// No step is longer than a way into the middle of the thinner shape.
TEST(ContactWithinSteps, NothingPassesThroughAThinPlate) {
  ContactScene s = scene_within_steps({});
  s.material() = {"stuff", 1e6, 0, 0, 0.3, 0};
  s.add_box("plate", 50, {1, 1, 0.02}, {0, 0, 0.01});
  const BodyId ball = s.add_ball("ball", 0.1, 0.05, {0, 0, 1});
  s.body(ball).twist.v_WB = {0, 0, -15};
  ContactRun run(s.scene, 1e-2);
  run.advance(30);
  std::printf("  height of the ball above the plate: %.3f m\n", run.position(1).z);
  EXPECT_GT(run.position(1).z, 0.05);
}

}  // namespace contact_within_steps_test
}  // namespace tandem::mbd
