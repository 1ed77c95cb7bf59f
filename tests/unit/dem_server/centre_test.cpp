#include "particles/state/centre.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dem_server/contact/parameters.hpp"

namespace tandem::dem {
namespace {

constexpr double radius = 0.01, skin = 0.005;  // [m]

LengthUnit<float> unit() {
  return LengthUnit<float>::for_lengths(counted_length(radius, skin));
}

double largest(Vec3d v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

TEST(Centre, IsKeptByPlaceAndRestTogether) {
  for (const double farthest : {0.1, 3.0, 1e4}) {
    const auto centres = CentreUnit<float>::for_range(unit(), farthest, 4);
    std::printf("  up to %g m: %u bits for parts of %.1e m\n", farthest, centres.part_bits,
                centres.part.size);
    for (const double share : {1.0, 0.37, 1e-6, 0.0, -1e-12, -0.61, -1.0}) {
      const Vec3d x{share * farthest, -share * farthest / 3, share * share * farthest};
      const auto centre = centres.of(x);
      EXPECT_LE(largest(centres.metres(centre) - x), 0.5 * centres.part.size + 2e-16 * farthest);
      PositionRadius<float> position;
      FinePart<float> fine;
      centres.split(centre, position, fine);
      EXPECT_EQ(centres.joined(position, fine), centre);
      // Other spheres read the same centre in whole quanta, rounded down.
      const double quantum = static_cast<double>(unit().size);
      const double rounded_down = std::floor(centres.metres(centre).x / quantum);
      EXPECT_EQ(position.x, static_cast<std::int32_t>(
                                static_cast<std::uint32_t>(static_cast<std::int64_t>(rounded_down))));
    }
  }
}

TEST(Centre, MovesByLessThanAQuantum) {
  const auto centres = CentreUnit<float>::for_range(unit(), 0.4, 4);
  PositionRadius<float> position;
  FinePart<float> fine;
  centres.split(centres.of({-0.25, 0.1, 0}), position, fine);
  const PositionRadius<float> begin = position;
  const double step = 1e-15;  // [m], of a quantum of 2.9e-11 m
  for (int i = 0; i < 10000; ++i)
    centres.split(centres.joined(position, fine) + centres.of({step, -step, 0}), position, fine);
  EXPECT_LE(position.x - begin.x, 1);
  EXPECT_NEAR(centres.metres(centres.joined(position, fine)).x, -0.25 + 10000 * step, 0.02 * 10000 * step);
  EXPECT_NEAR(centres.metres(centres.joined(position, fine)).y, 0.1 - 10000 * step, 0.02 * 10000 * step);
}

// A larger domain has coarser parts of a quantum; one that is too large exceeds range().
TEST(Centre, HasTheFinestPartsThatLeaveRoom) {
  double part = 0;
  for (const double farthest : {1e-3, 1.0, 50.0, 1e3, 1e6}) {
    const auto centres = CentreUnit<float>::for_range(unit(), farthest, 4);
    EXPECT_GE(centres.range(), 16 * farthest);
    EXPECT_GE(centres.part.size, part);
    EXPECT_LE(centres.part.size, std::max(std::ldexp(farthest, -56), 1.4e-15 * 2 * radius));
    part = centres.part.size;
  }
  EXPECT_LT(CentreUnit<float>::for_range(unit(), 1e9, 4).range(), 16 * 1e9);
}

TEST(Centre, IsTakenIntoAPeriodicDomain) {
  const auto centres = CentreUnit<float>::for_range(unit(), 2, 4);
  Periods periods;
  periods.min = {-0.3, 1, 0};
  periods.length = {std::nearbyint(0.8 * unit().inverse) * static_cast<double>(unit().size), 0, 0};
  const double period = periods.length.x;
  for (const double x : {-0.3, 0.1, 0.4999, 0.5001, 1.31, -0.30001, -1.7}) {
    const auto before = centres.of({x, 5, -3}), after = centres.wrapped(before, periods);
    const double moved = centres.metres(after - before).x / period;
    EXPECT_EQ(moved, std::nearbyint(moved)) << x;
    EXPECT_GE(after.x, centres.of(periods.min).x);
    EXPECT_LT(after.x, centres.of(periods.min + periods.length).x);
    EXPECT_EQ(after.y, before.y);
    EXPECT_EQ(after.z, before.z);
    EXPECT_EQ(centres.wrapped(after, periods), after);
  }
}

TEST(Velocity, IsKeptByDriftAndRestTogether) {
  for (const double size : {1e-12, 0.3, 1.0 + 1e-9, 7e4})
    for (int i = 0; i < 1000; ++i) {
      const Vec3d v{size * std::sin(i), -size * std::cos(i), i == 0 ? 0 : size / i};
      VelocityKind<float> velocity;
      FinePart<float> fine;
      set_velocity(v, velocity, fine);
      const Vec3d kept = velocity_of(velocity, fine);
      for (int a = 0; a < 3; ++a) {
        EXPECT_LE(std::abs(kept[a] - v[a]), std::ldexp(std::abs(v[a]), -48));
        // Other spheres read the nearest float; where two are equally near, either.
        EXPECT_LE(std::abs(static_cast<double>(velocity.v[a]) - v[a]),
                  std::abs(static_cast<double>(static_cast<float>(v[a])) - v[a]));
      }
      // Nothing is lost from step to step.
      set_velocity(kept, velocity, fine);
      EXPECT_EQ(velocity_of(velocity, fine), kept);
    }
}

}  // namespace
}  // namespace tandem::dem
