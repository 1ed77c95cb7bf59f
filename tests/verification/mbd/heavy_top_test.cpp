// The heavy top of the notes on a spherical joint: m = 15 kg, J = diag(.234375, .46875, .234375) kg m2, 1 m
// from the tip, started with 150 rad/s about its axis. Its speed follows from its position: the spin is
// constant and
//   v^2 = v0^2 - 2 m g z / (J1 + m l^2).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace {

constexpr double g = 9.81, m = 15, J1 = .234375, w0 = -4.61538;

double speed(double z) {
  return std::sqrt(w0 * w0 - 2 * m * g * z / (J1 + m));
}

void converges(double t, const Vector3d& exact, double first_step, int halvings) {
  OrderTable table("heavy top at t = " + std::to_string(t) + " s, rho_inf = 0.9");
  for (int k = 0; k <= halvings; ++k) {
    const int steps = static_cast<int>(std::lround(t / first_step)) << k;
    machines::Run run(machines::heavy_top(), t / steps);
    run.restart([](State& s) { s.u = Vector3d(0, 150, w0); });
    run.advance(steps);
    table.add(t / steps,
              {(run.position(0) - exact).norm(), std::abs(run.velocity(0).norm() - speed(exact.z()))});
    EXPECT_NEAR(run.state.q.norm(), 1, 1e-14) << "quaternion after " << steps << " steps";
  }
  table.expect_order(2.0, 0.1);
}

TEST(HeavyTop, ConvergesWithOrderTwoUpTo200ms) {
  converges(.2, {0.6055505613772, 0.5989576817948, -0.5239830274301}, 1e-3, 4);
}

TEST(HeavyTop, ConvergesWithOrderTwoUpTo1s) {
  converges(1, {0.1733439640987, 0.6400885920705, -0.7484907911336}, 5e-4, 4);
}

}  // namespace
}  // namespace tandem::mbd
