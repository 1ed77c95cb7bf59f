// Colours of pictures can be told apart, and the ends of a colour bar follow from the values.
#include "coordinator/report/colours.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tandem::launch {
namespace {

// A colour as a reader without one kind of cones sees it [Vienot1999]; rows are for red, green and blue of
// linear light.
struct Deficiency {
  Vec3d red, green, blue;
};
constexpr Deficiency none{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr Deficiency protanopia{{0.11238, 0.88762, 0}, {0.11238, 0.88762, 0}, {0.00401, -0.00401, 1}};
constexpr Deficiency deuteranopia{{0.29275, 0.70725, 0}, {0.29275, 0.70725, 0}, {-0.02234, 0.02234, 1}};

double linear(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// CIE L*a*b* for the white of sRGB.
Vec3d lab(Vec3d srgb, const Deficiency& sight) {
  const Vec3d light{linear(srgb.x), linear(srgb.y), linear(srgb.z)};
  const Vec3d c{dot(sight.red, light), dot(sight.green, light), dot(sight.blue, light)};
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = f((0.4124 * c.x + 0.3576 * c.y + 0.1805 * c.z) / 0.9505),
               y = f(0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z),
               z = f((0.0193 * c.x + 0.1192 * c.y + 0.9505 * c.z) / 1.089);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// The least difference of two of the first `count` colours; 2.3 is just noticeable.
template <class Colour>
double least_difference(Colour colour, std::size_t count, const Deficiency& sight) {
  double least = 1e300;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < i; ++k)
      least = std::min(least, norm(lab(colour(i), sight) - lab(colour(k), sight)));
  return least;
}

TEST(Colours, OfBodiesAndGroupsDifferForEverySight) {
  for (const Deficiency& sight : {none, protanopia, deuteranopia}) {
    EXPECT_GT(least_difference(body_colour, 7, sight), 10);
    EXPECT_GT(least_difference(body_colour, 21, sight), 2.3);
    EXPECT_GT(least_difference(group_colour, 6, sight), 10);
  }
  EXPECT_EQ(body_colour(21), body_colour(0));
}

TEST(Colours, OfTheBarBecomeLighter) {
  for (const Deficiency& sight : {none, protanopia, deuteranopia})
    for (int k = 1; k <= 16; ++k)
      EXPECT_GT(lab(bar_colour(k / 16.0), sight).x, lab(bar_colour((k - 1) / 16.0), sight).x);
}

TEST(ColourScale, IgnoresTheFastestHundredth) {
  std::vector<double> values(1000, 1);
  std::fill_n(values.begin(), 5, 50);
  ScaleRange range;
  range.add(values);
  const ColourScale scale = range.from_zero("speed [m/s]");
  EXPECT_EQ(scale.low, 0);
  EXPECT_EQ(scale.high, 1);
  EXPECT_TRUE(scale.exceeded);
  EXPECT_EQ(scale.colour(50), bar_colour(1));
}

TEST(ColourScale, CoversAllFrames) {
  ScaleRange range;
  range.add(std::vector<double>{0, 0, 0});
  range.add({});
  range.add(std::vector<double>{2, 3});
  EXPECT_EQ(range.whole("").low, 0);
  EXPECT_EQ(range.whole("").high, 3);
  EXPECT_EQ(range.from_zero("").high, 2);  // of two values the smaller is the 99th hundredth
}

TEST(ColourScale, HasTwoEndsAlsoForEqualValues) {
  ScaleRange range;
  EXPECT_LT(range.whole("").low, range.whole("").high);
  range.add(std::vector<double>{0, 0});
  EXPECT_LT(range.whole("").low, range.whole("").high);
  EXPECT_LT(range.from_zero("").low, range.from_zero("").high);
  EXPECT_FALSE(range.from_zero("").exceeded);
  ScaleRange radii;
  radii.add(std::vector<double>{4e-3, 4e-3});
  EXPECT_LT(radii.whole("").low, 4e-3);
  EXPECT_GT(radii.whole("").high, 4e-3);
}

TEST(ColourBar, HasRoundTicks) {
  EXPECT_EQ(ticks(0, 4), (std::vector<double>{0, 1, 2, 3, 4}));
  for (const auto& [low, high] : {std::pair{0.0, 0.0371}, {3.2e-3, 4.9e-3}, {-7.0, 1e5}, {0.0, 1e-12}}) {
    const std::vector<double> at = ticks(low, high);
    EXPECT_GE(at.size(), 2u);
    EXPECT_LE(at.size(), 6u);
    EXPECT_GE(at.front(), low - 1e-9 * (high - low));
    EXPECT_LE(at.back(), high + 1e-9 * (high - low));
  }
}

}  // namespace
}  // namespace tandem::launch
