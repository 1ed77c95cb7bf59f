// The levels of sizes; lists_test.cpp tests that lists are complete.
#include "particles/grid/size_levels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace tandem::particles::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Sizes = std::vector<double>;

Sizes both(Sizes a, const Sizes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(LevelsOfSizes, SizesWithinAFactorOfTwoAreOneLevel) {
  EXPECT_THAT(limits_of_levels(Sizes{1, 1.5, 2}), ElementsAre(2));
  EXPECT_THAT(limits_of_levels(Sizes(100, 3.0)), ElementsAre(3));
  EXPECT_THAT(limits_of_levels({}), IsEmpty());
}

TEST(LevelsOfSizes, EachBeginsBelowHalfOfTheNextOnesLargest) {
  EXPECT_THAT(limits_of_levels(both(Sizes(100, 1), both(Sizes(50, 2.1), both(Sizes(7, 4.4), Sizes{100})))),
              ElementsAre(1, 2.1, 4.4, 100));
  EXPECT_THAT(limits_of_levels(both(Sizes(100, 1), Sizes{1.9, 2, 3})), ElementsAre(1, 3));
}

TEST(LevelsOfSizes, FewFineSpheresAreInTheLevelOfTheNextCoarserOnes) {
  EXPECT_THAT(limits_of_levels(both(Sizes(20, 1), Sizes(10, 5))), ElementsAre(5));
  EXPECT_THAT(limits_of_levels(both(Sizes(21, 1), Sizes(10, 5))), ElementsAre(1, 5));
  // Spheres that are not much smaller cannot be more numerous near one sphere than fill the space.
  EXPECT_THAT(limits_of_levels(both(Sizes(1000, 1), Sizes(10'000, 2.1))), ElementsAre(2.1));
  EXPECT_THAT(limits_of_levels(both(Sizes(1000, 1), Sizes(9'000, 2.1))), ElementsAre(1, 2.1));
  // Together with the fine ones a level may then be worth its cells.
  EXPECT_THAT(limits_of_levels(both(Sizes(15, 3), Sizes(10, 9))), ElementsAre(9));
  EXPECT_THAT(limits_of_levels(both(Sizes(10, 1), both(Sizes(15, 3), Sizes(10, 9)))), ElementsAre(3, 9));
}

SkinRange skins() {
  SkinRange s;
  s.usual = 0.25;
  s.smallest = s.usual / 16;
  s.largest = 2 * s.usual;
  return s;
}

TEST(SizeLevels, CellsAreAsWideAsTheirLargestSpheresNeed) {
  const Sizes radii = both(Sizes(100, 1), both(Sizes(7, 8.5), Sizes{30}));
  const SizeLevels levels = make_size_levels({{0, 0, 0}, {500, 500, 500}}, {}, radii, skins(), 0);
  EXPECT_NEAR(1 / levels.finest[0].inverse_cell[0], 2.25, 1e-4);
  EXPECT_NEAR(1 / levels.finest[1].inverse_cell[0], 2.5, 1e-4);
  ASSERT_EQ(levels.coarse.size(), 2u);
  EXPECT_NEAR(1 / levels.coarse[0].grid.inverse_cell[1], 17.5, 1e-4);
  EXPECT_NEAR(1 / levels.coarse[1].grid.inverse_cell[2], 60.5, 1e-4);
  EXPECT_EQ(levels.coarse[1].first_cell, levels.coarse[0].grid.total);
  EXPECT_EQ(levels.cells(),
            levels.finest[0].total + levels.coarse[0].grid.total + levels.coarse[1].grid.total);
}

// For spheres of one size the existence of levels changes nothing, not even by rounding.
TEST(SizeLevels, OfOneSizeAreOneGrid) {
  const SizeLevels levels = make_size_levels({{0, 0, 0}, {100, 100, 100}}, {}, Sizes(100, 1), skins(), 0);
  EXPECT_THAT(levels.coarse, IsEmpty());
  EXPECT_EQ(levels.largest_of_finest, 1);
  EXPECT_EQ(levels.finest[0].inverse_cell[0], 1 / 2.25);
}

// Where a period limits the skin, cells are as wide as possible, without room for rounding.
TEST(SizeLevels, FitIntoAPeriodThatLimitsTheSkin) {
  const Sizes radii = both(Sizes(100, 1), Sizes{4});
  for (const double period : {24.78, 25.158, 25.537}) {
    SkinRange s = skins();
    s.largest = period * (1 - 1e-8) / 3 - 8;
    Periods periods;
    periods.length = {period, period, period};
    const SizeLevels levels = make_size_levels({{0, 0, 0}, periods.length}, periods, radii, s, 0);
    EXPECT_EQ(levels.coarse.size(), 1u);
  }
}

// In a layer the grid with wider cells may have more cells.
TEST(SizeLevels, CountTheCellsOfBothGridsOfTheFinest) {
  SkinRange s = skins();
  for (double* skin : {&s.usual, &s.smallest, &s.largest}) *skin *= 1e-3;
  const SizeLevels levels = make_size_levels({{0, 0, 0}, {9.5, 9.5, 0.002}}, {}, Sizes(100, 1e-3), s, 0);
  EXPECT_GT(levels.finest[1].total, levels.finest[0].total);
  EXPECT_EQ(levels.cells(), levels.finest[1].total);
}

TEST(SizeLevels, NoSphereLooksBeyondTheDomain) {
  const SizeLevels levels =
      make_size_levels({{0, 0, 0}, {300, 300, 0.5}}, {}, both(Sizes(100, 1), Sizes{2000}), skins(), 0);
  EXPECT_EQ(cells_within(levels.finest[0], 0, 4000), levels.finest[0].cells[0] - 1);
  EXPECT_EQ(levels.finest[0].cells[2], 1);
  EXPECT_EQ(cells_within(levels.finest[0], 2, 4000), 1);
}

// In a vast domain a coarse level has fewer cells than the finest one.
TEST(SizeLevels, CoarseOnesHaveFewerCells) {
  const SizeLevels levels =
      make_size_levels({{0, 0, 0}, {1e5, 1e5, 1e5}}, {}, both(Sizes(100, 1), Sizes{3}), skins(), 0);
  ASSERT_EQ(levels.coarse.size(), 1u);
  EXPECT_LE(levels.coarse[0].grid.total, levels.finest[0].total / 4);
  EXPECT_GT(levels.coarse[0].grid.apart2, 0);
}

TEST(SizeLevels, ASphereOfAShortPeriodMeetsNoCellTwice) {
  const Sizes radii = both(Sizes(100, 1), Sizes{2.01});
  SkinRange wide;
  wide.usual = wide.smallest = wide.largest = 2;
  Periods periods;
  periods.length = {20, 20, 20};
  const SizeLevels levels = make_size_levels({{0, 0, 0}, {20, 20, 20}}, periods, radii, wide, 0);
  const double reach = 2.01 + levels.largest_of_finest + wide.largest;
  for (const CellGrid& g : levels.finest) EXPECT_LE(2 * cells_within(g, 0, reach) + 1, g.cells[0]);
}

}  // namespace
}  // namespace tandem::particles::test
