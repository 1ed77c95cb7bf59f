// What is between two points, and what the lists make of it.
#include <gtest/gtest.h>

#include "sph_server/neighbours/neighbour_list.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace {

using namespace sph;

// A sheet in the plane x = 0 with a hole where |y| < 0.1 and z is above 1.
TriangleMesh sheet() {
  TriangleMesh m;
  m.vertices = {{0, -2, 0}, {0, 2, 0}, {0, 2, 1}, {0, -2, 1}, {0, -0.1, 1}, {0, -0.1, 2}, {0, -2, 2}};
  m.triangles = {{0, 1, 2}, {0, 2, 3}, {3, 4, 5}, {3, 5, 6}};
  return m;
}

TEST(Walls, AreBetweenPointsOnBothSides) {
  const Walls walls({sheet()}, 0.5);
  EXPECT_TRUE(walls.between({-0.1, 0, 0.5}, {0.1, 0.2, 0.5}));
  EXPECT_TRUE(walls.between({0.1, 0.2, 0.5}, {-0.1, 0, 0.5}));
  EXPECT_FALSE(walls.between({0.1, 0, 0.5}, {0.3, 0, 0.5}));
  EXPECT_FALSE(walls.between({-0.1, 0, 1.5}, {0.1, 0, 1.5})) << "through the hole";
  // The diagonal between two triangles belongs to both.
  EXPECT_TRUE(walls.between({-0.1, 0, 0.5}, {0.1, 0, 0.5}));
}

TEST(Walls, AreFoundWhereTheirBodyIs) {
  Walls walls({sheet()}, 0.5);
  NearWalls near;
  walls.find({0.2, 0.5, 0.5}, 0.3, near);
  EXPECT_EQ(near.count, 2);
  walls.set_pose(0, {{5, 0, 0}, Mat3d::identity(), {}, {}});
  walls.find({0.2, 0.5, 0.5}, 0.3, near);
  EXPECT_EQ(near.count, 0);
  EXPECT_TRUE(walls.between({4.9, 0, 0.5}, {5.1, 0, 0.5}));
  EXPECT_TRUE(walls.passed({{{}, Mat3d::identity(), {}, {}}}, {0.1, 0, 0.5}, {4.9, 0, 0.5}))
      << "the wall moved across the point";
}

TEST(Walls, WithoutAreaAreRefused) {
  TriangleMesh m;
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  m.triangles = {{0, 1, 2}};
  EXPECT_EQ(error_of([&] { Walls({m}, 0.1); }),
            "scene: walls of body 0: triangle 0 has no area (remove it from the mesh)");
}

TEST(NeighbourList, EndsAtASheet) {
  const Walls walls({sheet()}, 0.5);
  const scene::Box domain{{-1, -1, 0}, {1, 1, 2}};
  const dem::CellGrid grid = dem::make_cell_grid(domain, {}, 0.5, 1e6);
  const std::vector<Vec3d> x{
      {-0.1, 0.5, 0.5}, {0.1, 0.5, 0.5}, {0.3, 0.5, 0.6}, {-0.05, 0, 1.5}, {0.05, 0, 1.5}};
  dem::ThreadPool pool(2);
  NeighbourList list;
  build_list(grid, {}, x, 0.5, walls, pool, list);
  EXPECT_EQ(list.start, (std::vector<std::uint32_t>{0, 0, 1, 2, 3, 4}));
  EXPECT_EQ(list.neighbour[0].index(), 2u);
  EXPECT_EQ(list.neighbour[2].index(), 4u);
}

}  // namespace
}  // namespace tandem::test
