// Contacts that begin and end within steps: what rebounds, slides and rests does as it does where each step
// ends at a contact, to an error that falls with the step and that error control bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace contact_within_steps_test {

using namespace contacts;

ContactScene scene_within_steps(double tolerance) {
  ContactScene s;
  s.add_floor();
  s.scene.contact->impacts = scene::Impacts::within_steps;
  s.scene.mbd->integrator.error_tolerance = tolerance;
  return s;
}

// Rate after an impact over the rate before, of a ball of 1 kg that falls onto 1e5 N/m: 10 ms of contact.
double rebound(double restitution, double tolerance, scene::Impacts impacts) {
  ContactScene s = scene_within_steps(tolerance);
  s.scene.contact->impacts = impacts;
  s.material() = {"stuff", 1e5, 0, 0, restitution, 0};
  const BodyId ball = s.add_ball("ball", 1, 0.1, {0, 0, 0.1 + 0.01});
  s.body(ball).twist.v_WB = {0, 0, -2};
  ContactRun run(s.scene, 2e-3);
  run.advance(15);
  // At the height at which the contact began.
  const double in = std::sqrt(4 + 2 * g * 0.01), v = run.velocity().z, z = run.position().z - 0.1;
  return std::sqrt(v * v + 2 * g * z) / in;
}

// As where each step ends at the contact; the weight of the ball acts during the contact.
TEST(ContactWithinSteps, ABallReboundsAsWhereTheImpactIsResolved) {
  for (const double e : {0.9, 0.5, 0.2}) {
    const double expected = rebound(e, 1e-9, scene::Impacts::resolved);
    EXPECT_NEAR(expected, e, 0.03);
    for (const double tolerance : {3e-5, 1e-6}) {
      std::printf("  restitution %.1f, error tolerance %.0e\n", e, tolerance);
      expect_near("rate after over rate before", rebound(e, tolerance, scene::Impacts::within_steps),
                  expected, tolerance > 2e-6 ? 0.005 : 0.001);
    }
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
  expect_near("largest error of the four heights [m]", error_of_heights(run, 4, 0.05, 0.1, 4e5), 0, 1e-7);
  expect_energy(run, 0.01);
}

// No step is longer than a way into the middle of the thinner shape.
TEST(ContactWithinSteps, NothingPassesThroughAThinPlate) {
  ContactScene s = scene_within_steps(1e-5);
  s.material() = {"stuff", 1e6, 0, 0, 0.3, 0};
  s.add_box("plate", 50, {1, 1, 0.02}, {0, 0, 0.01});
  const BodyId ball = s.add_ball("ball", 0.1, 0.05, {0, 0, 1});
  s.body(ball).twist.v_WB = {0, 0, -15};
  ContactRun run(s.scene, 1e-2);
  run.advance(30);
  std::printf("  the ball leaves the plate with %.3f of its energy\n",
              run.solver.observe().energy / run.start_energy);
  EXPECT_GT(run.position(1).z, 0.05);
  expect_energy(run, 0.01);
}

}  // namespace contact_within_steps_test
}  // namespace tandem::mbd
