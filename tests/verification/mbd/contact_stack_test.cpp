// Restitution where a body hits another one that stands on a support: two contacts in series.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mbd_server/forces/joint_force.hpp"
#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace {

using namespace contacts;

constexpr double stack_stiffness = 1e6;

// Rate with which a mass M that hits a mass m at the rate 1 returns, where m touches a floor: both contacts
// have the law of contact_force.hpp, k d (1 + c d'), c = x / max(v, v_d / 2), v_d = d sqrt(k / M), with
// v = 0 on the floor and v = 1 between the masses. By the classical method of Runge and Kutta.
double rate_after_stack(double m, double M, double restitution) {
  const double k = stack_stiffness, x = damping_number(restitution), h = 2e-3 * std::sqrt(m / k);
  using Vector = std::array<double, 4>;  // ways of m and of M to the floor, their rates
  const auto force = [&](double depth, double rate, double entry) {
    if (!(depth > 0)) return 0.;
    const double c = x / std::max(entry, 0.5 * depth * std::sqrt(k / M));
    return std::max(0., k * depth * (1 + c * rate));
  };
  const auto slope = [&](const Vector& y) {
    const double below = force(y[0], y[2], 0), between = force(y[1] - y[0], y[3] - y[2], 1);
    return Vector{y[2], y[3], (between - below) / m, -between / M};
  };
  const auto moved = [](Vector y, const Vector& by, double factor) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += factor * by[i];
    return y;
  };
  Vector y{0, 0, 0, 1};
  while (y[3] > 0 || y[1] > y[0]) {
    const Vector a = slope(y), b = slope(moved(y, a, h / 2)), c = slope(moved(y, b, h / 2)),
                 d = slope(moved(y, c, h));
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
  return -y[3];
}

// A ball of 1 kg hits a lighter one that touches the floor. It returns with what the integration above gives,
// and never faster than the restitution tells by more than 3 % of it.
TEST(ContactStack, HeavyBallReturnsFromALightOne) {
  for (const double e : {0.1, 0.3, 0.5, 0.8})
    for (const double m : {0.1, 0.01, 0.001}) {
      ContactScene s({0, 0, 0});
      s.add_floor();
      s.material() = {"stuff", stack_stiffness, 0, 0, e, 0};
      s.add_ball("light", m, 0.1, {0, 0, 0.1});
      const BodyId heavy = s.add_ball("heavy", 1, 0.1, {0, 0, 0.31});
      s.body(heavy).twist.v_WB = {0, 0, -1};
      ContactRun run(s.scene, 1e-3);
      run.advance(60);
      const double measured = run.velocity(1).z;
      const std::string what =
          "restitution " + std::to_string(e) + ", " + std::to_string(m) + " kg between: rate after";
      expect_near(what, measured, rate_after_stack(m, 1, e), 0.01 * e);
      EXPECT_LT(measured, 1.03 * e) << what;
      EXPECT_GT(measured, 0.82 * e) << what;
    }
}

// Two free balls keep to their restitution at any ratio of their masses.
TEST(ContactStack, TwoFreeBallsAtAnyRatioOfMasses) {
  for (const double e : {0.3, 0.8})
    for (const double m : {1e-4, 1e-2, 1., 1e2, 1e4}) {
      ContactScene s({0, 0, 0});
      s.material() = {"stuff", stack_stiffness, 0, 0, e, 0};
      s.add_ball("one", m, 0.1, {0, 0, 0});
      const BodyId other = s.add_ball("other", 1, 0.1, {0, 0, 0.21});
      s.body(other).twist.v_WB = {0, 0, -1};
      ContactRun run(s.scene, 1e-3);
      run.advance(60);
      expect_near("restitution " + std::to_string(e) + ", " + std::to_string(m) + " kg: rate after",
                  run.velocity(1).z - run.velocity(0).z, e, 0.01 * e);
    }
}

}  // namespace
}  // namespace tandem::mbd
