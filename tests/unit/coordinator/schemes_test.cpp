// The schemes against closed forms: limits of stability and orders in the window H, through the real
// protocol. docs/coupling.md derives the formulas.
#include "coordinator/schemes/schemes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "common/math/spectral_radius.hpp"
#include "coordinator/accounts/accounts.hpp"
#include "tests/unit/coordinator/fake_solvers.hpp"

namespace tandem::launch {
namespace {

using test::ExplicitStep;
using test::PointMass;
using test::Session;
using test::WallContact;
using Returns = WallContact::Returns;

// Spectral radius of one window, which is a linear map of (x, v, held force): its columns are the results for
// the three unit states. Mass and stiffness are 1, so that omega = 1 and omega H = H.
class WindowMap {
 public:
  WindowMap(ExplicitStep step, Returns returns, double zeta) : step_(step) {
    wall_.d = 2 * zeta;
    wall_.returns = returns;
  }

  double spectral_radius(double H) {
    std::vector<double> map;  // column by column
    for (int column = 0; column < 3; ++column) {
      mass_.x = column == 0;
      mass_.v = column == 1;
      protocol::BodyLoad held;
      held.mean.force.x = column == 2;
      session_.exchange.load.bodies = {held};
      session_.advance(step_, H);
      map.insert(map.end(), {mass_.x, mass_.v, session_.exchange.load.bodies[0].mean.force.x});
    }
    return tandem::spectral_radius(map);
  }

  // The largest H up to which the radius stays at one, by bisection; 0 when there is none.
  double limit() {
    const auto stable = [&](double H) { return spectral_radius(H) <= 1 + 1e-9; };
    double low = 5e-3, high = 3;
    if (!stable(low)) return 0;
    while (high - low > 1e-4) (stable((low + high) / 2) ? low : high) = (low + high) / 2;
    return low;
  }

 private:
  ExplicitStep step_;
  PointMass mass_{1};
  WallContact wall_;
  Session session_{mass_, wall_};
};

struct Case {
  const char* name;
  ExplicitStep step;
  Returns returns;
  double (*limit)(double zeta);  // closed form of the critical omega H
};

const Case cases[] = {
    {"parallel, end force", parallel, Returns::end_force,
     [](double z) {  // 2 z - s/2 = s (s/2 + 2 z)^2, solved by bisection: the left side falls, the right side
                     // grows
       double low = 0, high = 4;
       for (int i = 0; i < 60; ++i) {
         const double s = (low + high) / 2;
         (2 * z - s / 2 > s * (s / 2 + 2 * z) * (s / 2 + 2 * z) ? low : high) = s;
       }
       return low;
     }},
    {"parallel, window mean", parallel, Returns::window_mean,
     [](double z) { return 2 * z / (1 + 4 * z * z); }},
    {"mbd_first, end force", mbd_first, Returns::end_force, [](double z) { return std::min(4 * z, 1 / z); }},
    {"mbd_first, window mean", mbd_first, Returns::window_mean,
     [](double z) {
       const double b = 1 + 2 * z * z;
       return z == 0 ? 0 : (b - std::sqrt(b * b - 8 * z * z / 3)) / (2 * z / 3);
     }},
    {"dem_first, end force", dem_first, Returns::end_force,
     [](double z) { return std::sqrt(z * z + 2) - z; }},
    {"dem_first, window mean", dem_first, Returns::window_mean,
     [](double z) { return 2 * (std::sqrt(z * z + 1) - z); }},
};

class Stability : public testing::TestWithParam<Case> {};

TEST_P(Stability, LimitOnAWallContact) {
  const Case& c = GetParam();
  for (const double zeta : {0.0, 0.05, 0.2, 0.5}) {
    const double expected = c.limit(zeta), measured = WindowMap(c.step, c.returns, zeta).limit();
    std::printf("  %-24s zeta %.2f  critical omega H: expected %.4f  measured %.4f  tolerance 1 %%\n", c.name,
                zeta, expected, measured);
    EXPECT_NEAR(measured, expected, std::max(0.01 * expected, 1e-3));
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, Stability, testing::ValuesIn(cases), [](const auto& parameter) {
  std::string name = parameter.param.name;
  std::erase_if(name, [](char c) { return c == ',' || c == ' '; });
  return name;
});

TEST(Stability, HeldEndForceGrowsWithoutDamping) {
  WindowMap map(mbd_first, Returns::end_force, 0);
  for (const double s : {0.05, 0.2, 1.0}) {
    const double expected = std::sqrt(1 + s * s / 2), measured = map.spectral_radius(s);
    std::printf("  growth per window at omega H = %.2f: expected %.8f  measured %.8f\n", s, expected,
                measured);
    EXPECT_NEAR(measured, expected, 1e-9);
  }
}

// Error of the position after 1 s against x(t) = exp(-z w t) (cos wd t + z w / wd sin wd t), from rest at 1
// m.
double error_after_one_second(ExplicitStep step, double zeta, int windows) {
  const double w = 2 * M_PI, wd = w * std::sqrt(1 - zeta * zeta), t = 0.9;
  PointMass mass(1);
  WallContact wall;
  wall.k = w * w;
  wall.d = 2 * zeta * w;
  mass.x = 1;
  Session session(mass, wall);
  for (int i = 0; i < windows; ++i) session.advance(step, t / windows);
  const double exact = std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t));
  return std::abs(mass.x - exact);
}

struct OrderCase {
  const char* name;
  ExplicitStep step;
  double zeta;
  double order;
};

class Order : public testing::TestWithParam<OrderCase> {};

TEST_P(Order, InTheWindow) {
  const OrderCase& c = GetParam();
  double coarse = error_after_one_second(c.step, c.zeta, 250);
  for (const int windows : {500, 1000}) {
    const double fine = error_after_one_second(c.step, c.zeta, windows);
    const double measured = std::log2(coarse / fine);
    std::printf(
        "  %-10s zeta %.1f  %4d windows: error %.3e  order: expected %.0f  measured %.3f  tolerance 0.1\n",
        c.name, c.zeta, windows, fine, c.order, measured);
    EXPECT_NEAR(measured, c.order, 0.1);
    coarse = fine;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Schemes, Order,
    testing::Values(OrderCase{"parallel", parallel, 0.2, 1}, OrderCase{"mbd_first", mbd_first, 0.2, 1},
                    OrderCase{"dem_first", dem_first, 0.2, 1}, OrderCase{"dem_first", dem_first, 0.0, 2}),
    [](const auto& parameter) {
      return std::string(parameter.param.name) + (parameter.param.zeta > 0 ? "Damped" : "Undamped");
    });

TEST(Schemes, NoLoadActsInTheFirstWindowOfAHeldScheme) {
  for (const ExplicitStep step : {parallel, mbd_first}) {
    PointMass mass(1);
    WallContact wall;
    mass.x = 1;
    Session session(mass, wall);
    session.advance(step, 0.1);
    EXPECT_EQ(mass.x, 1);
    EXPECT_EQ(mass.v, 0);
    session.advance(step, 0.1);
    EXPECT_LT(mass.v, 0);
  }
}

TEST(Schemes, ParticlesSeeThePathThatTheSchemeSays) {
  PointMass mass(1);
  WallContact wall;
  mass.x = 1;
  Session session(mass, wall);
  session.advance(dem_first, 0.1);
  EXPECT_EQ(session.exchange.path.bodies[0].end_pose.p_WB.x, 1) << "predicted: constant velocity";
  EXPECT_LT(session.exchange.motion.bodies[0].end_pose.p_WB.x, 1) << "taken: under the load";
  session.advance(mbd_first, 0.1);
  EXPECT_EQ(session.exchange.path.bodies[0].end_pose.p_WB.x,
            session.exchange.motion.bodies[0].end_pose.p_WB.x);
}

// What the bodies get of a load: all of it, its mean, or its value at the end, held over the window.
TEST(Schemes, ALoadIsHeldInItsShape) {
  protocol::LoadSet load;
  protocol::BodyLoad body;
  body.mean = {{1, 2, 3}, {4, 5, 6}};
  body.first_moment = {{7, 8, 9}, {10, 11, 12}};
  body.end = {{13, 14, 15}, {16, 17, 18}};
  load.bodies = {body};
  const auto expect = [&](scene::LoadShape shape, Wrench mean, Wrench first_moment) {
    const protocol::BodyLoad held = shaped(load, shape).bodies.front();
    EXPECT_EQ(norm(held.mean.force - mean.force) + norm(held.mean.torque - mean.torque), 0);
    EXPECT_EQ(norm(held.first_moment.force - first_moment.force) +
                  norm(held.first_moment.torque - first_moment.torque),
              0);
  };
  expect(scene::LoadShape::linear, body.mean, body.first_moment);
  expect(scene::LoadShape::mean, body.mean, {});
  expect(scene::LoadShape::end, body.end, {});
}

}  // namespace
}  // namespace tandem::launch
