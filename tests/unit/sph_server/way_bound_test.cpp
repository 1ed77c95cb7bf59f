#include "sph_server/engine/way_bound.hpp"

#include <gtest/gtest.h>

namespace tandem::sph {
namespace {

// One second with 3 m/s against the vessel, 2 m/s2 now and 4 m/s2 in the step before.
TEST(WayBound, IsTheLongestWayOfASecondOrderStep) {
  Advance<double> step;
  step.dt = 1;
  step.weight = 0.5;
  step.properties.spacing = 0.1;
  StepFigures now;
  now.largest_acceleration = 4;
  WayBound way;
  way.begin();
  way.without_step_before(now);
  now.largest_acceleration = 2;
  now.largest_speed = 3;
  // The vessel moves at 5 m/s and stays 0.25 m behind that.
  way.add_step(step, now, {5, 0, 0}, {4.75, 0, 0});
  const double expected = 3 + 0.5 * (1.5 * 2 + 0.5 * 4) + 0.25;
  EXPECT_GE(way.farthest(), expected);
  EXPECT_NEAR(way.farthest(), expected, 1e-5);
  way.measured({0.04});
  EXPECT_DOUBLE_EQ(way.farthest(), 0.2);
}

TEST(WayBound, IsNoneWhereNothingIsKnown) {
  Advance<double> step;
  step.dt = 1;
  WayBound way;
  way.begin();
  way.forget();
  way.add_step(step, {}, {}, {});
  EXPECT_FALSE(way.farthest() < 1e300);
}

}  // namespace
}  // namespace tandem::sph
