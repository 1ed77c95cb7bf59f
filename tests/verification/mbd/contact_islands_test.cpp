// Free bodies that cannot touch within a step take steps of their own.
#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd::contacts {
namespace {

// The least gap between two balls is 2 mm; the first one has 1 m/s, and a window is 20 ms: the impact goes
// through all of them within one step, from islands that were apart at its begin.
TEST(ContactIslands, AnImpactGoesOnToIslandsThatWereApart) {
  constexpr int balls = 9;
  ContactScene s({0, 0, 0});
  s.material() = {"stuff", 1e8, 0, 0, 1, 0};
  for (int i = 0; i < balls; ++i) s.add_ball("ball" + std::to_string(i), 1, 0.05, {0.102 * i, 0, 0});
  s.body(BodyId{0}).twist.v_WB = {1, 0, 0};
  ContactRun run(s.scene, 0.02);
  run.advance(2);
  for (std::size_t i = 0; i < balls; ++i)
    expect_near("rate of ball " + std::to_string(i) + " [m/s]", run.velocity(i).x, i + 1 == balls ? 1 : 0,
                2e-3);
  expect_energy(run, 2e-3);
}

// One ball bounces, and eight fly: a step of each in each window, and the parabola to round-off.
TEST(ContactIslands, OthersDoNotTakeTheStepsOfAnImpact) {
  constexpr int flying = 8, windows = 50;
  ContactScene s;
  s.add_floor();
  s.material() = {"stuff", 1e6, 0, 0, 0.5, 0};
  s.add_ball("bouncing", 1, 0.05, {0, 0, 0.1});
  for (int i = 0; i < flying; ++i) s.add_ball("flying" + std::to_string(i), 1, 0.05, {1.0 + i, 0, 5});
  ContactRun run(s.scene, 4e-3);
  run.advance(windows);
  const double t = 4e-3 * windows;
  for (std::size_t i = 1; i <= flying; ++i)
    expect_near("height of a ball that flies [m]", run.position(i).z, 5 - 0.5 * g * t * t, 1e-12);
  const double steps = run.facts().at("mbd_steps").get<double>();
  ContactScene alone;
  alone.add_floor();
  alone.material() = s.material();
  alone.add_ball("bouncing", 1, 0.05, {0, 0, 0.1});
  ContactRun one(alone.scene, 4e-3);
  one.advance(windows);
  expect_near("steps", steps, flying * windows + one.facts().at("mbd_steps").get<double>(), 20);
  expect_near("height of the ball that bounces [m]", run.position(0).z, one.position(0).z, 1e-6);
}

TEST(ContactIslands, GiveTheSameBitsAfterARollbackAndARestart) {
  expect_same_bits_after_rollback_and_restart(falling_boxes(12).scene, 60, 20, "contact_islands_test.state");
}

// Boxes on the floor sleep; a ball that falls on one of them wakes it, and both sleep again on the depth of
// their weight.
TEST(ContactIslands, SleepAtRestAndWake) {
  constexpr int boxes = 8, windows = 800;
  constexpr double k = 1e5, side = 0.1, window = 2e-3;
  ContactScene s;
  s.add_floor();
  s.material() = {"stuff", k, 0, 0, 0.2, 0.5};
  for (int i = 0; i < boxes; ++i)
    s.add_box("box" + std::to_string(i), 1, {side, side, side}, {0.5 * i, 0, side / 2});
  s.add_ball("ball", 1, 0.03, {0, 0, 1.5});
  ContactRun run(s.scene, window);
  run.advance(windows);
  expect_near("height of a box that sleeps [m]", run.position(1).z, side / 2 - g / (4 * k), 1e-8);
  expect_near("height of the box under the ball [m]", run.position(0).z, side / 2 - 2 * g / (4 * k), 1e-7);
  expect_near("height of the ball [m]", run.position(boxes).z, side + 0.03 - 2 * g / (4 * k) - g / k, 1e-7);
  EXPECT_EQ(run.velocity(1).z, 0);
  const double steps = run.facts().at("mbd_steps").get<double>();
  std::printf("  steps %g, of all bodies in all windows %d\n", steps, (boxes + 1) * windows);
  EXPECT_LT(steps, 0.5 * (boxes + 1) * windows);
  EXPECT_GT(run.facts().at("mbd_body_contacts").get<double>(), 0);
}

// In both orders each island has the same bodies, in another order: round-off.
TEST(ContactIslands, DoNotDependOnTheOrderOfBodies) {
  constexpr int boxes = 12;
  ContactRun one(falling_boxes(boxes).scene, 2e-3), two(falling_boxes(boxes, true).scene, 2e-3);
  one.advance(60), two.advance(60);
  double worst = 0;
  for (std::size_t i = 0; i < boxes; ++i)
    worst = std::max(worst, norm(one.position(i) - two.position(boxes - 1 - i)));
  expect_near("largest distance between the two orders [m]", worst, 0, 1e-7);
}

}  // namespace
}  // namespace tandem::mbd::contacts
