// Closed loops against exact values: A01 in cut-joint form, A02 with N windows.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>

#include "mbd_server/io/observation.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace {

using scene::JointType;

// The pendulum of A01 as a free body on a cut revolute joint.
scene::Scene cut_pendulum() {
  scene::Scene scene = machines::empty({0, -9.81, 0});
  const BodyId mass = machines::add_body(scene, "mass", 1, {1e-9, 1e-9, 1e-9}, {-1, 0, 0});
  machines::add_joint(scene, "pin", JointType::spherical, ground, mass, {0, 0, 0}).cut = true;
  return scene;
}

// A02: N windows of uniform rods of 1 m and 1 kg, verticals up, turning at -1 rad/s.
scene::Scene ladder(int windows) {
  scene::Scene scene = machines::empty({0, -9.81, 0});
  const double I = 1.0 / 12;
  std::vector<BodyId> vertical;
  for (int i = 0; i <= windows; ++i) {
    const double x = i;
    vertical.push_back(machines::add_body(scene, "v" + std::to_string(i), 1, {I, 1e-3, I}, {x, .5, 0}));
    machines::add_joint(scene, "a" + std::to_string(i), JointType::revolute, ground, vertical.back(), {x, 0, 0})
        .rate = -1;
  }
  for (int i = 0; i < windows; ++i) {
    const double x = i;
    const BodyId bar = machines::add_body(scene, "h" + std::to_string(i), 1, {1e-3, I, I}, {x + .5, 1, 0});
    machines::add_joint(scene, "b" + std::to_string(i), JointType::revolute, vertical[i], bar, {x, 1, 0});
    machines::add_joint(scene, "c" + std::to_string(i), JointType::revolute, bar, vertical[i + 1], {x + 1, 1, 0});
  }
  return scene;
}

// B0, the top of the first vertical, twice its centre of mass.
Vector3d top(machines::Run& run) { return 2 * run.position(0); }

double energy_error(machines::Run& run, int steps) {
  run.system.residual(run.state);
  const double E0 = energy(run.model, run.system.links());
  double worst = 0;
  for (int i = 0; i < steps; ++i) {
    run.advance(1);
    run.system.residual(run.state);
    worst = std::max(worst, std::abs(energy(run.model, run.system.links()) - E0));
  }
  return worst;
}

TEST(CutPendulum, FollowsTheClosedForm) {
  for (const Constraints form : {Constraints::index2, Constraints::index3}) {
    OrderTable table(form == Constraints::index2 ? "A01 cut, index 2, t = 1 s" : "A01 cut, index 3, t = 1 s");
    for (int n = 500; n <= 4000; n *= 2) {
      machines::Run run(cut_pendulum(), 1.0 / n, 0.9, {1e-12, 30}, form);
      run.advance(n);
      const Vector3d p = run.position(0);
      table.add(1.0 / n, {(p - Vector3d(0.986291751131875, -0.165010853125541, 0)).norm(),
                          std::abs(run.velocity(0).norm() - std::sqrt(2 * 9.81 * 0.165010853125541))});
    }
    table.expect_order(2.0, 0.1);
  }
}

TEST(Ladder, OfTwoWindowsFollowsTheClosedForm) {
  OrderTable table("A02, N = 2, t = 1 s, index 2");
  const Vector3d exact(-0.195020301949435, -0.980799205662174, 0);
  // theta'^2 = 1 + 2 c g (1 - sin theta), c = [(N+1)/2 + N] / [(N+1)/3 + N]
  const double c = 3.5 / 3, speed = std::sqrt(1 + 2 * c * 9.81 * (1 - exact.y()));
  for (int n = 500; n <= 4000; n *= 2) {
    machines::Run run(ladder(2), 1.0 / n, 0.9, {1e-12, 30});
    EXPECT_EQ(run.assembly.redundant.size(), 6u);
    run.advance(n);
    table.add(1.0 / n, {(top(run) - exact).norm(), std::abs(2 * run.velocity(0).norm() - speed)});
  }
  table.expect_order(2.0, 0.1);
}

TEST(Ladder, KeepsItsEnergyThroughSingularPositions) {
  machines::Run run(ladder(2), 1e-3, 0.9, {1e-11, 30});
  const double error = energy_error(run, 10000);
  std::printf("A02, N = 2, h = 1e-3 s, 10 s: energy error %.3g J, limit 1.1e-3 J; B0 off by %.2e m\n", error,
              (top(run) - Vector3d(0.328458111540815, 0.944518538178601, 0)).norm());
  EXPECT_LT(error, 1.1e-3);
}

TEST(Ladder, CostsTheSamePerWindow) {
  for (const int windows : {40, 1000}) {
    machines::Run run(ladder(windows), 1e-3, 0.9, {1e-10, 30});
    const std::clock_t begin = std::clock();
    run.advance(20);
    std::printf("A02, N = %d: %.2f us per step and window\n", windows,
                1e6 * double(std::clock() - begin) / CLOCKS_PER_SEC / 20 / windows);
    // theta' = -1 at the start and theta'' = -c g cos theta: x = -sin-like motion, checked by the exact ODE.
    double theta = std::acos(-1.0) / 2, rate = -1;
    const double c = (.5 * (windows + 1) + windows) / ((windows + 1) / 3.0 + windows), h = 1e-6;
    for (int i = 0; i < 20000; ++i) {
      rate += h / 2 * -c * 9.81 * std::cos(theta);
      theta += h * rate;
      rate += h / 2 * -c * 9.81 * std::cos(theta);
    }
    EXPECT_LT((top(run) - Vector3d(std::cos(theta), std::sin(theta), 0)).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace tandem::mbd
