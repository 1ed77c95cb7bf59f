// Numbers and warnings of the cells; lists_test.cpp tests that lists are complete.
#include "particles/grid/cell_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace tandem::particles::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double radius = 0.001, needed = 2.25 * radius;  // [m]

std::string warning(std::size_t spheres, double extent, double height = 0) {
  const std::vector<double> radii(spheres, radius);
  const scene::Box box{{0, 0, 0}, {extent, extent, height > 0 ? height : extent}};
  return warn_of_full_cells(make_cell_grid(box, {}, needed, most_cells(spheres)), box, needed, radii);
}

TEST(FullCells, AreToldOfWhereTheDomainIsVast) {
  EXPECT_THAT(warning(100'000, 1), IsEmpty());
  EXPECT_THAT(warning(100'000, 1000), AllOf(HasSubstr("as the domain is vast"), HasSubstr("dem.domain")));
  EXPECT_THAT(warning(1'000, 1000), IsEmpty());
}

// A layer of spheres has fewer in such a cell than a deep bed.
TEST(FullCells, AreNotToldOfALayer) {
  EXPECT_THAT(warning(1'000'000, 30, 0.001), IsEmpty());
}

// Blocks of 4 x 4 x 4 cells have four times as many cells as a layer of one.
TEST(CellGrid, OfAThinDomainHasNoMoreCellsThanOthers) {
  for (const double height : {1e-3, 5e-4}) {
    const CellGrid grid =
        make_cell_grid({{0, 0, 0}, {100, 100, height}}, {}, 0.00225, most_cells(100'000'000));
    EXPECT_LE(grid.total, 800'000'000u);
    EXPECT_EQ(grid.total, 64ull * grid.blocks[0] * grid.blocks[1] * grid.blocks[2]);
    EXPECT_LT(1 / grid.inverse_cell[0], 0.02);
  }
  const CellGrid line = make_cell_grid({{0, 0, 0}, {1e9, 1e-3, 1e-3}}, {}, 0.00225, most_cells(1000));
  EXPECT_LE(line.total, 64'000'000u);
}

// 100 million packed spheres need half as many cells.
TEST(CellGrid, HasAsManyCellsAsSpheresNeed) {
  const scene::Box box{{0, 0, 0}, {8, 8, 8}};
  EXPECT_NEAR(1 / make_cell_grid(box, {}, 0.0225, most_cells(100'000'000)).inverse_cell[0], 0.0225, 1e-15);
  EXPECT_NEAR(1 / make_cell_grid(box, {}, 0.0225, most_cells(1'000'000)).inverse_cell[0], 8 / std::cbrt(16e6),
              1e-15);
}

}  // namespace
}  // namespace tandem::particles::test
