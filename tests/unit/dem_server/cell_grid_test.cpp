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

std::string warning(const std::vector<double>& radii, double extent) {
  const double largest = *std::max_element(radii.begin(), radii.end()), needed = 2.25 * largest;
  const CellGrid grid = make_cell_grid({{0, 0, 0}, {extent, extent, extent}}, {}, needed, radii.size());
  return warn_of_full_cells(grid, needed, radii);
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

// 100 million packed spheres need half as many cells.
TEST(CellGrid, HasAsManyCellsAsSpheresNeed) {
  const scene::Box box{{0, 0, 0}, {8, 8, 8}};
  EXPECT_NEAR(1 / make_cell_grid(box, {}, 0.0225, 100'000'000).inverse_cell[0], 0.0225, 1e-15);
  EXPECT_NEAR(1 / make_cell_grid(box, {}, 0.0225, 1'000'000).inverse_cell[0], 8 / std::cbrt(16e6), 1e-15);
}

}  // namespace
}  // namespace tandem::dem::test
