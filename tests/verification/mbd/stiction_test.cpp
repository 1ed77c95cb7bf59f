// Joints with stiction, against closed forms: a joint that sticks keeps its coordinate to the bit, and one
// that slides has a constant force.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/log.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace stiction_test {

using scene::JointType;

// A run through the solver as a participant, in windows of one length.
struct StictionRun {
  MbdSolver solver;
  double window;
  std::uint64_t done = 0;

  StictionRun(scene::Scene scene, double window_, std::optional<double> step = {}) : window(window_) {
    log::setup("test", "error");
    scene.coupling.window = window;
    if (step) scene.mbd->integrator.step = step;
    solver.configure(scene);
  }
  void advance(int windows) {
    protocol::LoadSet loads;
    for (int i = 0; i < windows; ++i, ++done) {
      loads.window = {done, to_nanoseconds(static_cast<double>(done) * window),
                      to_nanoseconds(static_cast<double>(done + 1) * window)};
      solver.advance(loads);
    }
  }
  double q(int i = 0) const { return solver.state().q[i]; }
  double u(int i = 0) const { return solver.state().u[i]; }
  double residual_of_energy() {
    return nlohmann::json::parse(solver.report().facts).at("mbd_energy_balance_J").get<double>();
  }
};

// A block of mass m on a rail along x, with friction; `pull` acts along the rail.
scene::Scene block(double m, double force, double breakaway, scene::Motion pull, double rate = 0) {
  scene::Scene scene = machines::bead(m, rate);
  scene.mbd->joints[0].friction = scene::Friction{force, 0, breakaway};
  scene.mbd->forces.push_back(scene::Actuator{"pull", JointId{0}, std::move(pull)});
  return scene;
}

void expect_value(const char* what, double measured, double expected, double tolerance) {
  std::printf("  %-52s expected %14.9g measured %14.9g error %9.2e tolerance %7.1e\n", what, expected,
              measured, std::abs(measured - expected), tolerance);
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

// An incline holds a block by friction up to the limit, for an hour, in steps of 1 s or of 1 ms, and under
// error control.
TEST(Stiction, StaysForAnHour) {
  for (const bool controlled : {false, true}) {
    scene::Scene scene = machines::empty({9.81 * std::sin(.3), 0, -9.81 * std::cos(.3)});
    const BodyId body = machines::add_body(scene, "block", 2, {1, 1, 1}, {0, 0, 0});
    machines::add_joint(scene, "slope", JointType::prismatic, ground, body, {0, 0, 0}, {1, 0, 0}).friction =
        scene::Friction{2, 0, 2 * 9.81 * std::sin(.3) * (1 + 1e-6)};
    if (controlled) scene.mbd->integrator.error_tolerance = 1e-6;
    StictionRun run(scene, 1);
    run.advance(3600);
    std::printf("  %s after %g s: expected 0 m, measured %g m, tolerance 0\n",
                controlled ? "error control" : "steps of 1 s", run.solver.state().time, run.q());
    EXPECT_EQ(run.q(), 0);
    EXPECT_EQ(run.u(), 0);
    EXPECT_EQ(run.residual_of_energy(), 0);
  }
}

// A force r t passes the breakaway force B at B / r. From then on m v' = r t - F.
TEST(Stiction, BreaksAwayAtItsLimit) {
  const double m = 2, F = 3, B = 5, r = 10, end = 1, t0 = B / r, t = end;
  const double v = (r * (t * t - t0 * t0) / 2 - F * (t - t0)) / m;
  const double x =
      (r * (t * t * t / 6 - t0 * t0 * t / 2 + t0 * t0 * t0 / 3) - F * (t - t0) * (t - t0) / 2) / m;
  for (const bool controlled : {false, true}) {
    scene::Scene scene = block(m, F, B, scene::ConstantMotion{0, r});
    if (controlled) scene.mbd->integrator.error_tolerance = 1e-8;
    double last = 0;
    for (const double step : {.02, .01}) {
      StictionRun run(scene, .1, step);
      run.advance(4);
      EXPECT_EQ(run.q(), 0);
      run.advance(6);
      std::printf("  steps of %g s%s\n", step, controlled ? ", controlled" : "");
      expect_value("rate [m/s]", run.u(), v, 1e-8);
      expect_value("displacement [m]", run.q(), x, controlled ? 1e-6 : .3 * step * step);
      const double error = std::abs(run.q() - x);
      if (last > 0 && !controlled) expect_value("order", std::log2(last / error), 2, .1);
      last = error;
      EXPECT_LT(std::abs(run.residual_of_energy()), 1.5 * step * step);
    }
  }
}

// A block that slides is at rest after m v / F, at m v^2 / 2 F, and stays there.
TEST(Stiction, ComesToRestAndStays) {
  const double m = 2, F = 3, v = .7;
  StictionRun run(block(m, F, F, scene::ConstantMotion{}, v), .1, .1);
  run.advance(10);
  expect_value("distance [m]", run.q(), m * v * v / (2 * F), 1e-12);
  const double rest = run.q();
  run.advance(100);
  EXPECT_EQ(run.q(), rest);
  EXPECT_EQ(run.u(), 0);
  expect_value("residual of the energy [J]", run.residual_of_energy(), 0, 1e-12);
}

// A force of 0.9 F that jumps in does not move the block; one of 1.2 F moves it from that time on.
TEST(Stiction, HoldsAForceThatJumps) {
  const double m = 2, F = 3;
  for (const double share : {.9, -.9, 1.2, -1.2}) {
    scene::TableMotion jump;
    jump.times = {0, .35}, jump.values = {0, share * F}, jump.interpolation = scene::Interpolation::step;
    StictionRun run(block(m, F, F, jump), .1, .05);
    run.advance(10);
    const double excess = std::abs(share) > 1 ? std::copysign(std::abs(share) - 1, share) * F : 0;
    expect_value(share > 0 ? "rate [m/s]" : "rate, the other way [m/s]", run.u(), excess / m * .65, 1e-12);
    if (excess == 0) {
      EXPECT_EQ(run.q(), 0);
    }
  }
}

// A spring pulls the block to and fro: each half swing is about the point at which the spring balances
// friction, so that the amplitude falls by 2 F / k. The block stays where the spring is weaker than friction.
TEST(Stiction, SwingsComeToRestWhereTheSpringIsWeak) {
  const double m = 1, k = 100, F = 3, x0 = .5;
  scene::Scene scene = machines::bead(m, 0);
  scene.mbd->joints[0].friction = scene::Friction{F, 0, F};
  scene.mbd->forces.push_back(
      scene::SpringDamper{"spring", ground, BodyId{0}, {-10, 0, 0}, {0, 0, 0}, k, 0, 10 - x0});
  double x = -x0;  // elongation of the spring is q + x0
  double place = x0;
  int swings = 0;
  while (k * std::abs(place) > F) place = -(place - std::copysign(2 * F / k, place)), ++swings;
  x = place - x0;
  double last = 0;
  for (const double step : {.01, .005}) {
    StictionRun run(scene, .1, step);
    run.advance(60);
    std::printf("  %d half swings, steps of %g s\n", swings, step);
    expect_value("place of rest [m]", run.q(), x, 40 * step * step * x0);
    EXPECT_EQ(run.u(), 0);
    const double error = std::abs(run.q() - x), resting = run.q();
    if (last > 0) {
      std::printf("  order: expected at least 2, measured %.2f, tolerance 0.3\n", std::log2(last / error));
      EXPECT_GT(std::log2(last / error), 1.7);
    }
    last = error;
    run.advance(10);
    EXPECT_EQ(run.q(), resting);
  }
}

// A slider-crank whose slider has stiction: the torque on the crank that friction balances follows from
// virtual work, T = F dx/da.
TEST(Stiction, HoldsAClosedLoop) {
  const double r = .1, L = .35, a = .8, F = 20;
  const Vec3d pin{r * std::cos(a), r * std::sin(a), 0};
  const double x = pin.x + std::sqrt(L * L - pin.y * pin.y);
  const double dx = -r * std::sin(a) - r * r * std::sin(a) * std::cos(a) / std::sqrt(L * L - pin.y * pin.y);
  for (const double share : {.999, 1.001}) {
    scene::Scene scene = machines::empty({0, 0, 0});
    const BodyId crank = machines::add_body(scene, "crank", .5, {1e-3, 1e-3, 1e-3}, .5 * pin);
    const BodyId rod = machines::add_body(scene, "rod", .4, {1e-3, 1e-3, 4e-3}, .5 * (pin + Vec3d{x, 0, 0}));
    const BodyId slider = machines::add_body(scene, "slider", .6, {1e-3, 1e-3, 1e-3}, {x, 0, 0});
    machines::add_joint(scene, "shaft", JointType::revolute, ground, crank, {0, 0, 0});
    machines::add_joint(scene, "pin", JointType::revolute, crank, rod, pin);
    machines::add_joint(scene, "end", JointType::revolute, rod, slider, {x, 0, 0}).cut = true;
    machines::add_joint(scene, "guide", JointType::prismatic, ground, slider, {x, 0, 0}, {1, 0, 0}).friction =
        scene::Friction{F, 0, F};
    scene.mbd->forces.push_back(
        scene::Actuator{"torque", JointId{0}, scene::ConstantMotion{share * F * std::abs(dx), 0}});
    StictionRun run(scene, .01);
    run.advance(20);
    const double turned = std::abs(run.q(0));
    std::printf("  torque of %.3f F |dx/da|: the crank turned by %.3g rad in 0.2 s\n", share, turned);
    if (share < 1) {
      EXPECT_LT(turned, 1e-12);
    } else {
      EXPECT_GT(turned, 1e-4);
    }
  }
}

// The state on disk says which joints stick and which slide: a run that continues has the same bits.
TEST(Stiction, ContinuesFromAFile) {
  const double m = 1, F = 3;
  scene::Scene scene = block(m, F, 1.5 * F, scene::HarmonicMotion{0, 8, .7, 0});
  StictionRun straight(scene, .1, .05), resumed(scene, .1, .05);
  const std::string path = testing::TempDir() + "stiction.mbd";
  for (const int windows : {1, 4, 8}) {
    straight.advance(windows);
    straight.solver.checkpoint({straight.done, to_nanoseconds(straight.solver.state().time), path});
    resumed.solver.resume({straight.done, to_nanoseconds(straight.solver.state().time), path});
    resumed.done = straight.done;
    straight.advance(3), resumed.advance(3);
    EXPECT_EQ(hash(straight.solver.state()), hash(resumed.solver.state()));
  }
  std::filesystem::remove(path);
}

}  // namespace stiction_test
}  // namespace tandem::mbd
