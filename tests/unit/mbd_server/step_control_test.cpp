// Error control: the estimate, the tolerance, rejected steps, and its errors.
#include "mbd_server/step/step_control.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"
#include "tests/unit/mbd_server/workshop.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

// Compares all that a step starts from and that a run must restore.
void expect_same_bits(const State& a, const State& b) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.u, b.u);
  EXPECT_EQ(a.udot, b.udot);
  EXPECT_EQ(a.a, b.a);
  EXPECT_EQ(a.udot_rate, b.udot_rate);
  EXPECT_EQ(a.lambda, b.lambda);
  EXPECT_EQ(a.next_step, b.next_step);
  EXPECT_EQ(a.last_error, b.last_error);
  EXPECT_EQ(a.loads, b.loads);
  EXPECT_EQ(hash(a), hash(b));
}

struct Controlled {
  machines::Run run;
  StepControl control;

  Controlled(const scene::Scene& scene, const StepControlSettings& settings, double first_step = 1e-3,
             double rho_inf = 0.9, Constraints constraints = Constraints::index2)
      : run(scene, first_step, rho_inf, {1e-13, 30}, constraints), control(settings) {}

  double step(double end) { return control.step(run.integrator, run.system, run.state, end); }
  void advance(double end) {
    while (end - run.state.time > 1e-12) step(end);
  }
  std::uint64_t rejected() const { return run.integrator.counters().rejected; }
};

// One step against a thousand short ones from the same state. The rate of the acceleration before that step
// is that of the short ones.
TEST(StepControl, EstimatesBecomeTheLocalErrors) {
  for (const double rho_inf : {.5, .9, 1.}) {
    std::printf(
        "pendulum at 0.7 rad below the horizontal, 2.5 rad/s, rho_inf = %.1f\n%10s %13s %13s %7s %13s %13s "
        "%7s\n",
        rho_inf, "h [s]", "estimate", "error [rad]", "ratio", "estimate", "error [rad/s]", "ratio");
    double ratio = 0, velocity_ratio = 0;
    for (const double h : {2e-2, 1e-2, 5e-3, 2.5e-3}) {
      machines::Run run(machines::pendulum(), h, rho_inf), fine(machines::pendulum(), h / 1000, rho_inf);
      const auto start = [](State& s) { s.q[0] = .7, s.u[0] = 2.5; };
      run.restart(start), fine.restart(start);
      // Long enough for the filtered acceleration to be independent of its start.
      run.advance(2);
      fine.state.q = run.state.q, fine.state.u = run.state.u;
      fine.integrator.start(fine.system, fine.state, h / 1000);
      const std::optional<LocalError> estimate = run.integrator.try_step(run.system, run.state, h);
      fine.advance(1000);
      ASSERT_TRUE(estimate);
      const double error = std::abs(run.state.q[0] - fine.state.q[0]);
      const double velocity_error = std::abs(run.state.u[0] - fine.state.u[0]);
      ratio = estimate->position / error, velocity_ratio = estimate->velocity / velocity_error;
      std::printf("%10.2e %13.4e %13.4e %7.3f %13.4e %13.4e %7.3f\n", h, estimate->position, error, ratio,
                  estimate->velocity, velocity_error, velocity_ratio);
    }
    EXPECT_NEAR(ratio, 1, .1);
    EXPECT_NEAR(velocity_ratio, 1, .1);
  }
}

// A01 to t = 10 s: a tolerance on the error of each step, of third order in h, bounds the global error, of
// second order, by its power 2/3; the number of steps grows with its power -1/3.
TEST(StepControl, ReachesTheToleranceOnThePendulum) {
  const Vector3d exact(-0.275087462576117, -0.961419205099125, 0);
  std::printf("A01 with error control, t = 10 s, rho_inf = 0.9\n%10s %8s %9s %13s %7s %7s\n", "tolerance",
              "steps", "rejected", "error [m]", "power", "power");
  double last_error = 0, last_steps = 0;
  for (const double tolerance : {1e-6, 1e-7, 1e-8, 1e-9, 1e-10}) {
    Controlled c(machines::pendulum(), {.tolerance = tolerance}, 1e-3);
    c.advance(10);
    const double error = (c.run.position(0) - exact).norm();
    const auto steps = static_cast<double>(c.run.state.steps);
    std::printf("%10.0e %8.0f %9d %13.3e", tolerance, steps, static_cast<int>(c.rejected()), error);
    if (last_error > 0) {
      const double power = std::log10(last_error / error), growth = std::log10(steps / last_steps);
      std::printf(" %7.3f %7.3f", power, growth);
      EXPECT_NEAR(power, 2. / 3, .1);
      EXPECT_NEAR(growth, 1. / 3, .05);
    }
    std::printf("\n");
    // The errors of the steps add up: 40 covers their growth over 10 s of this motion.
    EXPECT_LT(error, 40 * std::pow(tolerance, 2. / 3));
    last_error = error, last_steps = steps;
  }
  EXPECT_LT(last_error, 1e-5);
}

TEST(StepControl, TakesShortStepsWhereTheMotionIsFast) {
  // A bead between stiff stops, without friction: free flight is a straight line.
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId bead = machines::add_body(scene, "bead", 1, {1, 1, 1}, {0, 0, 0});
  scene::Joint& rail =
      machines::add_joint(scene, "rail", scene::JointType::prismatic, ground, bead, {0, 0, 0}, {1, 0, 0});
  rail.rate = 1;
  rail.limits = scene::Limits{-.5, .5, 1e6, 0};
  Controlled c(scene, {.tolerance = 1e-8, .max_step = .05}, 1e-3, 1);
  double shortest = 1, longest = 0;
  while (c.run.state.time < 5) {
    const double h = c.step(5);
    shortest = std::min(shortest, h), longest = std::max(longest, h);
  }
  std::printf(
      "bead between stops of 1e6 N/m, 5 s: steps %.1e to %.1e s, %d accepted, %d rejected; speed %.9f m/s\n",
      shortest, longest, static_cast<int>(c.run.state.steps), static_cast<int>(c.rejected()),
      std::abs(c.run.state.u[0]));
  EXPECT_GT(c.rejected(), 0u);
  EXPECT_EQ(longest, .05);
  EXPECT_LT(shortest, 1e-3);  // a contact lasts 3.1 ms
  EXPECT_NEAR(std::abs(c.run.state.u[0]), 1, 1e-3);
}

// A position that is always right to the tolerance may hide a wrong velocity: after an impact at v the bead
// moves into the stop by v sqrt(m/k) only, which at 1e12 N/m is the tolerance itself.
TEST(StepControl, SeesTheVelocityAfterAHit) {
  for (const double stiffness : {1e4, 1e6, 1e8, 1e10, 1e12}) {
    scene::Scene scene = machines::empty({0, 0, 0});
    const BodyId bead = machines::add_body(scene, "bead", 1, {1, 1, 1}, {0, 0, 0});
    scene::Joint& rail =
        machines::add_joint(scene, "rail", scene::JointType::prismatic, ground, bead, {0, 0, 0}, {1, 0, 0});
    rail.rate = 1;
    rail.limits = scene::Limits{-.5, .5, stiffness, 0};
    Controlled c(scene, {.tolerance = 1e-6, .max_step = .01}, 1e-3);
    c.advance(1);
    std::printf("bead at 1 m/s, stop of %.0e N/m: %4d steps, %2d rejected; speed after the hit %.9f m/s\n",
                stiffness, static_cast<int>(c.run.state.steps), static_cast<int>(c.rejected()),
                -c.run.state.u[0]);
    EXPECT_NEAR(c.run.state.u[0], -1, 2e-3);
  }
}

// A change of step disturbs the accelerations of index 3 in the directions of the constraints, by an amount
// that does not fall with the step. Counted as an error of the velocity it takes ten times as many steps at
// 1e-8, and two hundred times as many at 1e-10.
TEST(StepControl, Index3TakesAboutAsManyStepsAsIndex2) {
  const scene::Scene scene = machines::shipped("squeezer");
  for (const double tolerance : {1e-6, 1e-8}) {
    double steps[2]{}, angle[2]{};
    for (const Constraints constraints : {Constraints::index2, Constraints::index3}) {
      Controlled c(scene, {.tolerance = tolerance, .max_step = 3e-4}, 3e-4, 0.9, constraints);
      c.advance(.015);
      const int k = constraints == Constraints::index3;
      steps[k] = static_cast<double>(c.run.state.steps), angle[k] = c.run.joint("B").q;
      std::printf("squeezer, index %d, tolerance %.0e: %5.0f steps, %4.0f rejected, beta %.9f rad\n", 2 + k,
                  tolerance, steps[k], static_cast<double>(c.rejected()), angle[k]);
    }
    EXPECT_LT(steps[1], 2.5 * steps[0]);
    EXPECT_NEAR(angle[1], angle[0], 10 * std::pow(tolerance, 2. / 3));
  }
}

// The slope of a load may jump from window to window, which is not an error of the step.
TEST(StepControl, JumpsOfLoadsAreNoErrors) {
  machines::Run run(machines::free_body(2, {1, 1, 1}, {0, 0, 0}), 1e-2);
  scene::Scene scene = run.scene;
  machines::add_wall(scene, BodyId{0});
  machines::Run loaded(scene, 1e-2);
  loaded.advance(1);
  const State before = loaded.state;
  loaded.state.load_time = loaded.state.time;
  loaded.state.loads(3, 0) = 10;
  loaded.state.load_rates(3, 0) = 1000;
  loaded.integrator.jump(loaded.system, before, loaded.state);
  const std::optional<LocalError> estimate = loaded.integrator.try_step(loaded.system, loaded.state, 5e-3);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(loaded.state.u[0] + loaded.state.u[1] + loaded.state.u[2], (10 * 5e-3 + 500 * 25e-6) / 2,
              1e-14);
  EXPECT_LT(estimate->velocity, 1e-13);
}

TEST(StepControl, EndsWhereItIsTold) {
  Controlled c(machines::pendulum(), {.tolerance = 1e-6, .max_step = .03});
  for (const double end : {.1, .1001, .25, 1.}) {
    c.advance(end);
    EXPECT_NEAR(c.run.state.time, end, 1e-15);
  }
}

TEST(StepControl, UndoneStepLeavesNoTrace) {
  machines::Run run(workshop(), 1e-3);
  run.advance(40);
  ASSERT_GT(run.state.lambda.norm(), 1);
  ASSERT_FALSE(run.assembly.redundant.empty());
  const State before = run.state;
  ASSERT_TRUE(run.integrator.try_step(run.system, run.state, 4e-3));
  EXPECT_NE(run.state.lambda, before.lambda);
  EXPECT_NE(hash(run.state), hash(before));
  run.integrator.undo(run.state);
  expect_same_bits(run.state, before);

  // From here on the machine must behave like one that never tried the long step.
  machines::Run twin(workshop(), 1e-3);
  twin.advance(40);
  for (const double h : {2e-3, 2e-3, 5e-4, 1e-3}) {
    ASSERT_TRUE(run.integrator.try_step(run.system, run.state, h));
    ASSERT_TRUE(twin.integrator.try_step(twin.system, twin.state, h));
    expect_same_bits(run.state, twin.state);
  }
}

TEST(StepControl, StepWithoutConvergenceLeavesNoTrace) {
  machines::Run run(workshop(), 1e-3, .9, {1e-13, 3});
  const State before = run.state;
  EXPECT_FALSE(run.integrator.try_step(run.system, run.state, .2));
  expect_same_bits(run.state, before);
  EXPECT_EQ(run.integrator.counters().steps, 0u);
}

// Two runs, one of which is disturbed by rejected steps and restored from a copy in between.
TEST(StepControl, RestoredRunsContinueToTheSameBits) {
  const StepControlSettings settings{.tolerance = 1e-7, .max_step = .02};
  Controlled straight(workshop(), settings), broken(workshop(), settings);
  straight.advance(.3), broken.advance(.3);
  const State saved = broken.run.state;
  broken.advance(.35);
  broken.run.integrator.try_step(broken.run.system, broken.run.state, .05);
  broken.run.state = saved;
  straight.advance(.6), broken.advance(.6);
  std::printf("workshop to 0.6 s at a tolerance of 1e-7: %d steps, %d rejected\n",
              static_cast<int>(straight.run.state.steps), static_cast<int>(straight.rejected()));
  EXPECT_GT(straight.rejected(), 0u);
  expect_same_bits(straight.run.state, broken.run.state);
}

TEST(StepControl, SaysThatStepsGetTooShort) {
  Controlled c(machines::pendulum(), {.tolerance = 1e-13, .min_step = 1e-3}, 1e-2);
  try {
    c.advance(1);
    FAIL() << "a tolerance of 1e-13 needs steps far below 1 ms";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::numerics);
    EXPECT_EQ(error.where(), "mbd_server");
    EXPECT_EQ(error.problem().find("the error control asks for steps below 0.001 s at t = "), 0u)
        << error.what();
    std::printf("%s\n", error.what());
    EXPECT_NE(error.problem().find("times the tolerance, largest at joint \"pin\" of body \"mass\""),
              std::string::npos)
        << error.what();
    EXPECT_NE(error.hint().find("mbd.integrator.error_tolerance"), std::string::npos) << error.what();
    EXPECT_NE(error.hint().find("mbd.integrator.min_step"), std::string::npos) << error.what();
  }
}

// Where Newton's method fails down to the shortest step, the error is that of the method.
TEST(StepControl, SaysWhereNewtonFails) {
  Controlled c(machines::pendulum(), {.tolerance = 1e-6, .min_step = 1e-4}, 1e-3);
  c.run.integrator = GeneralizedAlpha(.9, {1e-30, 1}, c.run.system, c.run.state);
  c.run.integrator.start(c.run.system, c.run.state, 1e-3);
  const State before = c.run.state;
  try {
    c.advance(1);
    FAIL() << "1e-30 cannot be reached";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::numerics);
    EXPECT_NE(error.problem().find("Newton's method did not converge"), std::string::npos) << error.what();
    EXPECT_NE(error.problem().find("joint \"pin\" of body \"mass\""), std::string::npos) << error.what();
  }
  expect_same_bits(c.run.state, before);
}

}  // namespace
}  // namespace tandem::mbd
