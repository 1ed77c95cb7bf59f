// Functions of time whose derivatives jump: steps end at the jumps, forces give their exact impulse, and
// jumps of prescribed rates move the other bodies as rigid-body mechanics requires.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using scene::Interpolation;
using scene::JointType;
using scene::TableMotion;

// A run of the solver in windows of equal length, as the coordinator drives it.
class Driven {
 public:
  explicit Driven(scene::Scene scene) : scene_(std::move(scene)) {
    window_ = static_cast<std::int64_t>(std::llround(1e9 * scene_.coupling.window));
    solver.configure(scene_);
  }
  // Runs to a time, which is a whole number of windows [s].
  void run(double time) {
    while (solver.state().time < time - 1e-12) {
      protocol::LoadSet none;
      none.window = {next_, {std::int64_t(next_) * window_}, {std::int64_t(next_ + 1) * window_}};
      solver.predict(none.window);
      solver.advance(none);
      ++next_;
    }
  }
  double q(std::size_t joint) { return solver.observe().joints[joint].q; }
  double rate(std::size_t joint) { return solver.observe().joints[joint].rate; }

  MbdSolver solver;

 private:
  scene::Scene scene_;
  std::int64_t window_;
  std::uint64_t next_ = 0;
};

struct Setting {
  std::optional<double> step = 1e-3;
  std::optional<double> error_tolerance{};
  bool extrapolate = false;
  double rho_inf = .9;
};

scene::Scene with(scene::Scene scene, const Setting& s, double window = .01) {
  scene.coupling.window = window;
  scene.mbd->integrator.step = s.step;
  scene.mbd->integrator.error_tolerance = s.error_tolerance;
  scene.mbd->integrator.extrapolate = s.extrapolate;
  scene.mbd->integrator.rho_inf = s.rho_inf;
  return scene;
}

const Setting step_settings[] = {{},
                                 {.step = {}},
                                 {.step = 7e-4},
                                 {.rho_inf = 0},
                                 {.extrapolate = true},
                                 {.step = {}, .error_tolerance = 1e-7}};

// 1 kg on a slide, under a force that is a table.
scene::Scene pushed(const TableMotion& force) {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId b = machines::add_body(scene, "b", 1, {.1, .1, .1}, {0, 0, 0});
  machines::add_joint(scene, "j", JointType::prismatic, ground, b, {0, 0, 0}, {1, 0, 0});
  scene.mbd->forces.push_back(scene::Actuator{"a", JointId{0}, force});
  return scene;
}

// 0 N until 0.5 s, 100 N from 0.501 s: 0.05 N s in between, 49.9 N s until 1 s. A single step integrates
// straight lines exactly, but not a cubic.
TEST(Breaks, StepOfAForceGivesItsImpulse) {
  for (const Interpolation i : {Interpolation::linear, Interpolation::monotone})
    for (const Setting& s : step_settings) {
      Driven run(with(pushed({{0, .5, .501, 1}, {0, 0, 100, 100}, i}), s));
      run.run(.5);
      EXPECT_NEAR(run.rate(0), 0, 1e-13);
      run.run(1);
      std::printf("%s: %.3e of 49.95 m/s\n", i == Interpolation::linear ? "linear" : "monotone",
                  run.rate(0) - 49.95);
      EXPECT_NEAR(run.rate(0), 49.95, i == Interpolation::linear ? 1e-10 : s.rho_inf == 0 ? .06 : .02);
    }
}

// A ramp of 1 ms in the middle of a window that is one step: half its height on average.
TEST(Breaks, StepsDoNotContainASteepRamp) {
  scene::Scene scene = pushed({{0, 1}, {0, 0}});
  std::get<scene::Actuator>(scene.mbd->forces[0]).size = scene::RampMotion{0, 100, .4953, 1e-3};
  for (const Setting& s : step_settings) {
    Driven run(with(scene, s));
    run.run(1);
    EXPECT_NEAR(run.rate(0), 100 * (1 - .4958), s.rho_inf == 0 ? .06 : .02);
  }
}

// Steps at times inside the steps of the windows: 3 N for 0.3003 s, then -2 N, 5 N, nothing.
TEST(Breaks, SteppedForceGivesItsImpulse) {
  for (const Setting& s : step_settings) {
    Driven run(with(pushed({{0, .30033, .600071, .6000714, .77}, {3, -2, 5, 0, 1}, Interpolation::step}), s));
    run.run(1);
    const double impulse = 3 * .30033 - 2 * (.600071 - .30033) + 5 * 4e-7 + 1 * .23;
    EXPECT_NEAR(run.rate(0), impulse, 1e-10);
  }
}

// Breaks that differ from the end of a window by round-off, and two that differ by less than the time
// resolution.
TEST(Breaks, MakeNoStepsOfLengthZero) {
  Driven run(with(pushed({{0, .1 + 1e-17, .2 * (1 + 1e-15), .3, .3 * (1 + 1e-15), .55},
                          {0, 1, 2, 3, 4, 5},
                          Interpolation::step}),
                  {}));
  run.run(1);
  EXPECT_NEAR(run.rate(0), .1 * 1 + .1 * 2 + .25 * 4 + .45 * 5, 1e-10);
  EXPECT_EQ(run.solver.state().steps, 1000u);
}

// Two rods in a row, the first one driven from rest at the start by a spline that ends at 1 rad/s at 0.5 s.
scene::Scene two_rods(TableMotion motion) {
  scene::Scene scene = machines::empty({0, 0, 0});
  const BodyId b = machines::add_body(scene, "b", 1, {.1, .1, .1}, {1, 0, 0});
  const BodyId c = machines::add_body(scene, "c", 1, {.1, .1, .1}, {2, 0, 0});
  machines::add_joint(scene, "j", JointType::revolute, ground, b, {0, 0, 0}).motion = motion;
  machines::add_joint(scene, "k", JointType::revolute, b, c, {1, 0, 0});
  return scene;
}

// The second rod keeps its angular momentum about the hinge, which stops: (0.1 + 1) w = 0.1 * 1 + 1 * 2.
TEST(Breaks, MotionThatEndsAtSpeedLeavesTheNeighboursTheirMomentum) {
  for (const Setting& s : step_settings) {
    Driven run(with(two_rods({{0, .25, .5}, {0, .25, .5}, Interpolation::spline}), s));
    run.run(.49);
    EXPECT_NEAR(run.rate(1), 0, 1e-9);
    run.run(1);
    EXPECT_NEAR(run.rate(0), 0, 1e-14);
    EXPECT_NEAR(run.rate(1), 2.1 / 1.1, 1e-9);
    EXPECT_NEAR(run.q(1), .5 * 2.1 / 1.1, 1e-9);
  }
}

// The same rods in one closed loop with the ground: all of them stop.
TEST(Breaks, LoopStopsWithItsMotion) {
  scene::Scene scene = machines::ladder(1);
  for (scene::Joint& joint : scene.mbd->joints) joint.rate = 0;
  ASSERT_EQ(scene.mbd->joints[0].type, JointType::revolute);
  scene.mbd->joints[0].motion = TableMotion{{0, .1, .2}, {0, -.1, -.2}, Interpolation::spline};
  Driven run(with(scene, {}));
  run.run(.19);
  const auto& bodies = run.solver.observe().bodies;
  double before = 0;
  for (const auto& body : bodies) before += norm(body.twist.v_WB);
  EXPECT_GT(before, 1);
  run.run(.2);
  for (const auto& body : run.solver.observe().bodies) EXPECT_LT(norm(body.twist.v_WB), 1e-12);
  run.run(.4);
  for (const auto& body : run.solver.observe().bodies) EXPECT_LT(norm(body.twist.v_WB), 1e-10);
}

// Second order across jumps of the rate, of the acceleration and of a force, at times inside steps.
TEST(Breaks, OrderTwoIsKept) {
  const auto machine = [] {
    scene::Scene scene = two_rods({{0, .2, .31731}, {0, .25, .5}, Interpolation::spline});
    scene.gravity = {0, -9.81, 0};
    const BodyId d = machines::add_body(scene, "d", .5, {.02, .03, .04}, {2.5, .2, 0});
    machines::add_joint(scene, "l", JointType::revolute, BodyId{1}, d, {2, 0, 0});
    scene.mbd->forces.push_back(scene::Actuator{
        "a", JointId{2}, TableMotion{{0, .1111, .3333, .7777}, {0, 3, -2, 1}, Interpolation::linear}});
    scene.mbd->forces.push_back(
        scene::BodyLoad{"f",
                        scene::BodyLoad::Kind::force,
                        BodyId{1},
                        {2, 0, 0},
                        {1, 0, 0},
                        true,
                        TableMotion{{0, .2222, .4567}, {0, 5, 0}, Interpolation::step}});
    return scene;
  };
  const auto end = [&](double step, bool extrapolate = false) {
    Driven run(with(machine(), {.step = step, .extrapolate = extrapolate}, .1));
    run.run(.6);
    return Eigen::Vector3d(run.q(1), run.q(2), run.rate(1));
  };
  const Eigen::Vector3d fine = end(2e-5, true);
  double last = 0;
  for (const double h : {4e-3, 2e-3, 1e-3, 5e-4}) {
    const double error = (end(h) - fine).norm();
    std::printf("h = %.1e s: error %.3e, slope %.2f\n", h, error, last > 0 ? std::log2(last / error) : 0);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, .25);
    }
    last = error;
  }
  EXPECT_LT((end(1e-3, true) - fine).norm(), .1 * last);
}

// A restarted run continues with the same bits, whether it was saved before a break, in its window or after
// it.
TEST(Breaks, RestartIsToTheBit) {
  const auto scene = with(two_rods({{0, .25, .5}, {0, .25, .5}, Interpolation::spline}), {});
  for (const double saved : {.2, .5, .7}) {
    Driven run(scene);
    run.run(saved);
    const protocol::Checkpoint file{0, {std::llround(1e9 * saved)}, testing::TempDir() + "breaks_state.h5"};
    run.solver.checkpoint(file);
    run.run(1);
    MbdSolver again;
    again.configure(scene);
    again.resume(file);
    for (std::int64_t n = std::llround(100 * saved); n < 100; ++n) {
      protocol::LoadSet none;
      none.window = {std::uint64_t(n), {n * 10'000'000}, {(n + 1) * 10'000'000}};
      again.advance(none);
    }
    EXPECT_EQ(hash(again.state()), hash(run.solver.state())) << saved;
  }
}

// By default a motion stays between the values of neighbouring points, and ends at rest.
TEST(Breaks, StepOfAMotionDoesNotOvershoot) {
  scene::Scene scene = machines::empty({0, -9.81, 0});
  const BodyId b = machines::add_body(scene, "b", 1, {.1, .1, .1}, {1, 0, 0});
  machines::add_joint(scene, "j", JointType::revolute, ground, b, {0, 0, 0}).motion =
      TableMotion{{0, .5, .51, 1}, {0, 0, 1, 1}};
  Driven run(with(scene, {}, 1e-3));
  for (double t = 1e-3; t <= 1; t += 1e-3) {
    run.run(t);
    EXPECT_GE(run.q(0), 0);
    EXPECT_LE(run.q(0), 1);
  }
  EXPECT_EQ(run.q(0), 1);
}

}  // namespace
}  // namespace tandem::mbd
