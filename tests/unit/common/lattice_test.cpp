#include "common/scene/lattice.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tandem::scene {
namespace {

LatticeFill fill(const char* lattice, Vec3d size, double spacing) {
  LatticeFill fill;
  fill.min = {0, 0, 0};
  fill.max = size;
  fill.lattice = lattice;
  fill.spacing = spacing;
  return fill;
}

TEST(Lattice, CubicFillsTheBoxOfThePaper) {
  const LatticeFill box = fill("cubic", {1.1, 1.1, 1.1}, 0.1);
  EXPECT_EQ(lattice_capacity(box, 0.05), 1331);
  const auto sites = lattice_sites(box, 0.05, 1331);
  ASSERT_EQ(sites.size(), 1331u);
  EXPECT_EQ(sites[0], (Vec3d{0.05, 0.05, 0.05}));
  EXPECT_NEAR(sites[1].x - sites[0].x, 0.1, 1e-15) << "x runs first";
  EXPECT_NEAR(sites[1330].z, 1.05, 1e-12);
}

TEST(Lattice, HexagonalNeighboursTouchAndNoneIsNearer) {
  const double s = 0.1;
  const LatticeFill box = fill("hexagonal", {1, 1, 1}, s);
  const auto count = static_cast<std::uint64_t>(lattice_capacity(box, s / 2));
  const auto sites = lattice_sites(box, s / 2, count);
  ASSERT_EQ(sites.size(), count) << "the closed form and the walk agree";
  std::size_t most_neighbours = 0;
  for (const Vec3d& a : sites) {
    std::size_t neighbours = 0;
    for (int i = 0; i < 3; ++i) {
      EXPECT_GE(a[i], s / 2 - 1e-9);
      EXPECT_LE(a[i], 1 - s / 2 + 1e-9);
    }
    for (const Vec3d& b : sites) {
      const double distance = norm(a - b);
      if (&a == &b) continue;
      ASSERT_GE(distance, s * (1 - 1e-12));
      neighbours += distance < s * (1 + 1e-9);
    }
    most_neighbours = std::max(most_neighbours, neighbours);
  }
  EXPECT_EQ(most_neighbours, 12u);
  EXPECT_GT(lattice_capacity(box, s / 2), lattice_capacity(fill("cubic", {1, 1, 1}, s), s / 2));
}

TEST(Lattice, CapacityMatchesTheWalkForManySizes) {
  for (const char* lattice : {"cubic", "hexagonal"})
    for (double size = 0.1; size < 1; size += 0.037) {
      const LatticeFill box = fill(lattice, {size, 0.7 * size, 1.3 * size}, 0.11);
      const double capacity = lattice_capacity(box, 0.05);
      EXPECT_EQ(static_cast<double>(lattice_sites(box, 0.05, 1'000'000).size()), capacity)
          << lattice << " " << size;
    }
}

TEST(Lattice, StopsAtTheCount) {
  EXPECT_EQ(lattice_sites(fill("cubic", {1, 1, 1}, 0.1), 0.05, 17).size(), 17u);
}

TEST(Lattice, TooSmallABoxHoldsNone) {
  EXPECT_EQ(lattice_capacity(fill("cubic", {1, 1, 0.09}, 0.1), 0.05), 0);
  EXPECT_TRUE(lattice_sites(fill("cubic", {1, 1, 0.09}, 0.1), 0.05, 5).empty());
}

TEST(Lattice, HugeCapacityIsANumber) {
  EXPECT_GT(lattice_capacity(fill("cubic", {1, 1, 1}, 1e-12), 1e-13), 1e35);
}

}  // namespace
}  // namespace tandem::scene
