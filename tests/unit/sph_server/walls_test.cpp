// What is between two points, and what the lists make of it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sph_server/kernel/seen_integrals.hpp"
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
  const particles::CellGrid grid = particles::make_cell_grid(domain, {}, 0.5, 1e6);
  const std::vector<Vec3d> x{
      {-0.1, 0.5, 0.5}, {0.1, 0.5, 0.5}, {0.3, 0.5, 0.6}, {-0.05, 0, 1.5}, {0.05, 0, 1.5}};
  particles::ThreadPool pool(2);
  NeighbourList list;
  build_list(grid, {}, x, 0.5, walls, pool, list);
  EXPECT_EQ(list.start, (std::vector<std::uint32_t>{0, 0, 1, 2, 3, 4}));
  EXPECT_EQ(list.neighbour[0].index(), 2u);
  EXPECT_EQ(list.neighbour[2].index(), 4u);
}

// Of a lid that covers a round vessel, points inside see a polygon of as many corners as the vessel has.
TEST(Walls, HideWhatOfALidIsOutsideARoundVessel) {
  constexpr double radius = 0.35, level = 0.6, support = 0.3;
  const WallKernel kernel = WallKernel::of(support, support / 3);
  TriangleMesh lid;
  lid.vertices = {{-0.95, -0.95, level}, {0.95, -0.95, level}, {0.95, 0.95, level}, {-0.95, 0.95, level}};
  lid.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (const int segments : {8, 20, 24}) {
    const TriangleMesh vessel =
        transformed(cylinder_mesh(radius, 1.2, segments, {"+z"}), Pose{{0, 0, 0.6}, {}});
    const Walls walls({vessel, lid}, support);
    std::vector<Vec3d> rim;
    for (int k = 0; k < segments; ++k) {
      const double angle = 2 * std::numbers::pi * k / segments;
      rim.push_back({radius * std::cos(angle), radius * std::sin(angle), level});
    }
    for (const Vec3d x :
         {Vec3d{0.05, 0.02, 0.55}, Vec3d{-0.18, 0.1, 0.5}, Vec3d{0.2, 0, 0.577}, Vec3d{0.3, 0.02, 0.57}}) {
      NearWalls near;
      walls.find(x, support, near);
      bool overflow = false;
      FacetIntegrals seen;
      for (int k = 0; k < near.count; ++k)
        if (near.facet[k].body == 1) seen += seen_integrals(x, near, k, kernel, overflow);
      const FacetIntegrals expected = facet_integrals(x, rim.data(), segments, {0, 0, 1}, kernel);
      EXPECT_FALSE(overflow);
      EXPECT_NEAR(seen.surface, expected.surface, 1e-5 * expected.surface);
      EXPECT_NEAR(seen.shadow, expected.shadow, 1e-5 * expected.shadow);
    }
  }
}

}  // namespace
}  // namespace tandem::test
