// Of the cells only what is told of them; that lists are complete is shown by lists_test.cpp.
#include "dem_server/neighbours/cell_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tandem::dem::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

std::string warning(const std::vector<double>& radii, double extent, double height = 0) {
  const double largest = *std::max_element(radii.begin(), radii.end()), needed = 2.25 * largest;
  const scene::Box box{{0, 0, 0}, {extent, extent, height > 0 ? height : extent}};
  return warn_of_full_cells(make_cell_grid(box, {}, needed, radii.size()), box, needed, radii);
}

TEST(FullCells, AreToldOfWhereOneSphereIsMuchLarger) {
  std::vector<double> radii(100'000, 0.001);
  EXPECT_THAT(warning(radii, 1), IsEmpty());
  radii.push_back(0.002);
  EXPECT_THAT(warning(radii, 1), IsEmpty());
  radii.push_back(0.1);
  EXPECT_THAT(warning(radii, 1), AllOf(HasSubstr("cells are 0.225 m wide"), HasSubstr("(radius 0.1 m)"),
                                       HasSubstr("bodies with a wall of shape 'sphere'")));
  const std::vector<double> few(radii.end() - 1'000, radii.end());
  EXPECT_THAT(warning(few, 1), IsEmpty());
}

TEST(FullCells, AreToldOfWhereTheDomainIsVast) {
  const std::vector<double> radii(100'000, 0.001);
  EXPECT_THAT(warning(radii, 1000), AllOf(HasSubstr("as the domain is vast"), HasSubstr("dem.domain")));
}

// A layer of them holds fewer than such a cell of a deep bed.
TEST(FullCells, AreNotToldOfALayer) {
  const std::vector<double> radii(1'000'000, 0.001);
  EXPECT_THAT(warning(radii, 30, 0.001), IsEmpty());
}

// Blocks of 4 x 4 x 4 cells have four times as many as a layer of one.
TEST(CellGrid, OfAThinDomainHasNoMoreCellsThanOthers) {
  for (const double height : {1e-3, 5e-4}) {
    const CellGrid grid = make_cell_grid({{0, 0, 0}, {100, 100, height}}, {}, 0.00225, 100'000'000);
    EXPECT_LE(grid.total, 800'000'000u);
    EXPECT_EQ(grid.total, 64ull * grid.blocks[0] * grid.blocks[1] * grid.blocks[2]);
    EXPECT_LT(1 / grid.inverse_cell[0], 0.02);
  }
  const CellGrid line = make_cell_grid({{0, 0, 0}, {1e9, 1e-3, 1e-3}}, {}, 0.00225, 1000);
  EXPECT_LE(line.total, 64'000'000u);
}

// 100 million packed spheres need half as many cells.
TEST(CellGrid, HasAsManyCellsAsSpheresNeed) {
  const scene::Box box{{0, 0, 0}, {8, 8, 8}};
  EXPECT_NEAR(1 / make_cell_grid(box, {}, 0.0225, 100'000'000).inverse_cell[0], 0.0225, 1e-15);
  EXPECT_NEAR(1 / make_cell_grid(box, {}, 0.0225, 1'000'000).inverse_cell[0], 8 / std::cbrt(16e6), 1e-15);
}

}  // namespace
}  // namespace tandem::dem::test
