#include "sph_server/engine/put_back.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::sph {
namespace {

constexpr double a = 0.1;  // spacing

// A cubic lattice in a box of n spacings, and its walls.
std::vector<Vec3d> lattice(int n) {
  std::vector<Vec3d> sites;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) sites.push_back(a * Vec3d{i + 0.5, j + 0.5, k + 0.5});
  return sites;
}
Walls box(int n) {
  const double edge = n * a;
  TriangleMesh mesh = box_mesh({edge, edge, edge});
  for (Vec3d& v : mesh.vertices) v += Vec3d{edge / 2, edge / 2, edge / 2};
  Walls walls({mesh}, 3 * a);
  walls.set_pose(0, {{}, Mat3d::identity(), {}, {}});
  return walls;
}

TEST(PutBack, TakesTheWidestGapAwayFromWalls) {
  const std::vector<Vec3d> sites = lattice(8);
  std::vector<Vec3d> places = sites;
  // Two particles are outside. A hole of one particle is in the middle, another one beside a wall.
  const std::size_t middle = (3 * 8 + 3) * 8 + 4, beside_wall = (0 * 8 + 3) * 8 + 4;
  places[0] = places[middle] = places[beside_wall] = {-1, -1, -1};
  ASSERT_TRUE(put_back(places, {0}, sites, box(8), a));
  EXPECT_EQ(norm(places[0] - sites[middle]), 0);
}

TEST(PutBack, OfTwoParticlesDoesNotUseAPlaceTwice) {
  const std::vector<Vec3d> sites = lattice(8);
  std::vector<Vec3d> places = sites;
  const std::size_t first = (3 * 8 + 3) * 8 + 3, second = (5 * 8 + 3) * 8 + 3;
  places[first] = places[second] = {-1, -1, -1};
  ASSERT_TRUE(put_back(places, {first, second}, sites, box(8), a));
  EXPECT_NEAR(norm(places[first] - places[second]), 2 * a, 1e-12);
}

TEST(PutBack, KnowsWhenWallsAreEverywhere) {
  const std::vector<Vec3d> sites = lattice(2);
  std::vector<Vec3d> places = sites;
  places[0] = {-1, -1, -1};
  EXPECT_FALSE(put_back(places, {0}, sites, box(2), a));
}

}  // namespace
}  // namespace tandem::sph
