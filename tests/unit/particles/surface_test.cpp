#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <numbers>
#include <set>

#include "particles/geometry/facet_grid.hpp"
#include "particles/geometry/smooth_patches.hpp"
#include "tests/unit/dem_geometry/walls.hpp"

namespace tandem::particles::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string message(const std::function<void()>& f, ErrorCode code = ErrorCode::scene) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code);
    return e.what();
  }
  return "no error";
}

// ---- patches

TEST(SmoothPatches, FollowTheBendAndNotTheWinding) {
  // Two triangles over the edge (0,0,0)-(0,1,0), the second rising by `bend`, with either winding.
  const auto patches = [](double bend, bool flipped) {
    const double a = bend * std::numbers::pi / 180;
    TriangleMesh m;
    m.vertices = {{0, 0, 0}, {0, 1, 0}, {-1, 0.2, 0}, {0, 0, 0}, {0, 1, 0}, {std::cos(a), 0.7, std::sin(a)}};
    m.triangles = {{0, 1, 2}, {3, 4, 5}};
    if (flipped) std::swap(m.triangles[1][0], m.triangles[1][1]);
    const auto p = smooth_patches(m);
    return *std::max_element(p.begin(), p.end()) + 1;
  };
  for (const bool flipped : {false, true}) {
    for (const double bend : {0.0, 10.0, -24.9, 24.9}) EXPECT_EQ(patches(bend, flipped), 1u) << bend;
    for (const double bend : {25.1, -25.1, 90.0, 150.0, 179.0}) EXPECT_EQ(patches(bend, flipped), 2u) << bend;
  }
}

TEST(SmoothPatches, ARibDoesNotSplitItsPlate) {
  TriangleMesh m;
  m.vertices = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  m.triangles = {{0, 1, 2}, {0, 1, 4}, {0, 1, 3}};
  EXPECT_EQ(smooth_patches(m), (std::vector<std::uint32_t>{0, 1, 0}));
}

TEST(SmoothPatches, WeldsVerticesWithinSinglePrecision) {
  TriangleMesh box = box_mesh({0.3, 0.7, 1.1}), soup;
  Random random(2);
  for (const auto& t : box.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(box.vertices[v].as<float>().as<double>());
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const auto p = smooth_patches(soup);
  EXPECT_EQ(*std::max_element(p.begin(), p.end()), 5u);
}

// ---- grid

double point_triangle(const Facet& t, Vec3d p) {
  WallContact c;
  return touch_triangle(t, p, 1e6, c) ? c.gap + 1e6 : 1e6;
}

std::set<std::uint32_t> listed(const Surface& s, std::size_t body, Vec3d p) {
  const NearFacets near = near_facets(s.grids[body], s.cell_start.data(), s.cell_facet.data(), p);
  std::set<std::uint32_t> result;
  for (int i = 0; i < near.count; ++i) {
    if (i > 0) {
      EXPECT_LT(near[i - 1], near[i]);
    }
    result.insert(near[i]);
  }
  return result;
}

TEST(FacetGrid, ListsEveryFacetWithinReach) {
  Random random(3);
  for (const double reach : {0.02, 0.1, 0.7}) {
    TriangleMesh m;
    for (std::uint32_t i = 0; i < 120; ++i) {
      const Vec3d at = random.vector(-1, 1);
      const double size = i % 5 == 0 ? 1 : 0.1;
      for (int k = 0; k < 3; ++k) m.vertices.push_back(at + random.vector(-size, size));
      m.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const Surface s = mesh_surface(m, reach);
    std::size_t entries = 0, needed = 0;
    for (int i = 0; i < 5000; ++i) {
      // Near a triangle, and anywhere.
      const Vec3d at = s.facets[static_cast<std::size_t>(i) % s.facets.size()].b;
      const Vec3d p = i % 2 ? at + random.vector(-2 * reach, 2 * reach) : random.vector(-2.8, 2.8);
      const auto near = listed(s, 0, p);
      entries += near.size();
      for (std::uint32_t f = 0; f < s.facets.size(); ++f) {
        if (point_triangle(s.facets[f], p) > reach) continue;
        ++needed;
        ASSERT_TRUE(near.contains(f)) << i;
      }
    }
    std::cout << "reach " << reach << ": listed " << entries << ", within reach " << needed << "\n";
    EXPECT_LT(entries, 12 * needed + 1000);
  }
}

TEST(FacetGrid, StaysSmallForLargeTrianglesAndTinySpheres) {
  const Surface s = surface_of({wall("box", scene::BoxShape{{100, 100, 100}, {}})}, 1e-4);
  EXPECT_LT(s.cell_start.size(), std::size_t{1} << 21);
  EXPECT_EQ(listed(s, 0, {49.99999, 1, 2}).size(), 2u);
  EXPECT_TRUE(listed(s, 0, {0, 0, 0}).empty());
  EXPECT_TRUE(listed(s, 0, {0, 0, std::nan("")}).empty());
  EXPECT_TRUE(listed(s, 0, {0, 1e300, 0}).empty());
}

TEST(FacetGrid, StaysSmallForFineMeshesAndLargeSpheres) {
  // Triangles a thousand times smaller than the sphere.
  const Surface s = surface_of({wall("drum", scene::CylinderShape{1, 2, 5000, {}})}, 0.3);
  EXPECT_LT(s.cell_facet.size(), std::size_t{1} << 23);
  EXPECT_GT(listed(s, 0, {0.8, 0, 0}).size(), 500u);
}

TEST(FacetGrid, ListsFewBallsOfAFloorAndAllThatCanBeTouched) {
  // A floor of 1,000 balls of different sizes at random positions, in a box of triangles; small and large
  // spheres.
  for (const double reach : {0.005, 0.03, 0.1}) {
    Random random(11);
    std::vector<scene::Wall> walls{wall("box", scene::BoxShape{{4, 4, 4}, {}})};
    for (int x = 0; x < 40; ++x)
      for (int y = 0; y < 25; ++y)
        walls.push_back(wall("ball", scene::SphereShape{random(0.03, 0.05)}, ground,
                             {Vec3d{0.1 * (x - 20), 0.1 * (y - 12), 0} + random.vector(-0.02, 0.02), {}}));
    walls.push_back(wall("hall", scene::SphereShape{200}));  // too large for the grid
    const Surface s = surface_of(walls, reach);
    EXPECT_EQ(s.grids[0].analytic, 1u);
    std::size_t entries = 0, needed = 0, most = 0;
    for (int i = 0; i < 5000; ++i) {
      const Vec3d p{random(-2.2, 2.2), random(-1.4, 1.4), random(-0.2, 0.2)};
      const auto near = listed(s, 0, p);
      entries += near.size() - 1;
      most = std::max(most, near.size());
      for (std::uint32_t f = 0; f < s.facets.size(); ++f) {
        WallContact touch;
        if (!touch_facet(s.facets.data(), f, p, reach, touch)) continue;
        ++needed;
        ASSERT_TRUE(near.contains(f)) << i;
      }
    }
    std::cout << "reach " << reach << ": listed " << entries << ", at most " << most << ", touched " << needed
              << "\n";
    EXPECT_LT(entries, 12 * needed + 1000);
    EXPECT_LT(most, 40u);
  }
}

TEST(FacetGrid, ListsAHollowBallWhereItsSurfaceIs) {
  const Surface s = surface_of({wall("bowl", scene::SphereShape{1})}, 0.05);
  EXPECT_EQ(s.grids[0].analytic, 0u);
  EXPECT_TRUE(listed(s, 0, {0, 0, 0}).empty());
  EXPECT_TRUE(listed(s, 0, {0, 1.2, 0}).empty());
  EXPECT_EQ(listed(s, 0, {0, 0.97, 0}).size(), 1u);
  EXPECT_EQ(listed(s, 0, {0, 1.04, 0}).size(), 1u);
}

TEST(FacetGrid, TellsWhenTheFacetsExceedItsBudget) {
  std::vector<Facet> facets(20);
  for (std::size_t i = 0; i < facets.size(); ++i) facets[i] = triangle_facet({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  std::vector<std::uint32_t> start, list;
  EXPECT_THAT(message(
                  [&] {
                    make_facet_grid(facets, 0, 0.1, {100, 19}, start, list);
                  },
                  ErrorCode::resource),
              HasSubstr("20 facets on one body; at most 19"));
  const FacetGrid grid = make_facet_grid(facets, 7, 0.1, {100, 20}, start, list);
  EXPECT_EQ(grid.cells[0] * grid.cells[1] * grid.cells[2], 1);
  EXPECT_EQ(list.front(), 7u);
}

// ---- bodies

TEST(Surface, GroundIsSlotZeroAndBodiesFollowInSceneOrder) {
  const scene::PlaneShape floor{{0, 0, -5}, {0, 0, 1}};
  const scene::BoxShape box{{1, 2, 3}, {}};
  const Surface s = surface_of({wall("b3", box, BodyId{3}), wall("floor", floor), wall("b1", box, BodyId{1}),
                                wall("lid", floor, BodyId{3}, {{0, 0, 1}, exp({std::numbers::pi, 0, 0})})},
                               0.1);
  ASSERT_EQ(s.grids.size(), 3u);
  EXPECT_EQ(s.boundary_bodies, (std::vector<BodyId>{ground, BodyId{1}, BodyId{3}}));
  EXPECT_EQ(s.grids[0].cells[0], 0);
  EXPECT_EQ(s.grids[0].analytic, 1u);
  EXPECT_EQ(s.grids[2].analytic, 1u);
  EXPECT_EQ(s.patches.size(), 1u + 6 + 6 + 1);
  for (const Facet& f : s.facets) EXPECT_LT(f.patch, s.patches.size());
  EXPECT_FALSE(std::isfinite(s.body_extent[0])) << "a plane has no end";
  EXPECT_DOUBLE_EQ(s.body_extent[1], std::sqrt(14.0) / 2);
  // The lid: its point turned upside down and moved.
  const Facet lid = s.facets[s.grids[2].first_analytic];
  EXPECT_NEAR(lid.a.z, 6, 1e-14);
  EXPECT_NEAR(lid.normal.z, -1, 1e-15);
  EXPECT_EQ(lid.body, 2u);
  EXPECT_EQ(s.patch_wall[lid.patch], 3u);
  EXPECT_EQ(contacts(s, {0.45, 0, 0}, 0.1, 1).size(), 1u);
}

TEST(Surface, WithoutWallsHasAnEmptyGround) {
  const Surface s = surface_of({}, 0.1);
  ASSERT_EQ(s.grids.size(), 1u);
  EXPECT_EQ(s.cell_start, (std::vector<std::uint32_t>{0}));
  EXPECT_TRUE(contacts(s, {0, 0, 0}, 0.1).empty());
}

TEST(Surface, NamesWallAndTriangleOfABadMesh) {
  TriangleMesh m = box_mesh({1, 1, 1});
  m.triangles.push_back({0, 1, 0});
  EXPECT_THAT(
      message([&] { mesh_surface(m, 0.1); }),
      AllOf(HasSubstr("dem.walls[0] 'mesh'"), HasSubstr("triangle 12 has no area"), HasSubstr("1 of 13")));
  EXPECT_THAT(message([&] { mesh_surface({}, 0.1); }), HasSubstr("the mesh has no triangles"));
  EXPECT_THAT(message([&] { surface_of({wall("hopper", scene::MeshShape{"hopper.stl"})}, 0.1); }),
              AllOf(HasSubstr("'hopper'"), HasSubstr("no mesh came")));
  EXPECT_THAT(message([&] { surface_of({wall("floor", scene::PlaneShape{})}, 0.1); }),
              HasSubstr("has no length"));
}

TEST(Surface, AFineRoundMeshIsOnePatch) {
  const Surface s = surface_of({wall("drum", scene::CylinderShape{1, 2, 5000, {"+z", "-z"}})}, 0.01);
  EXPECT_EQ(s.facets.size(), 10000u);
  EXPECT_EQ(s.patches.size(), 1u);
}

}  // namespace
}  // namespace tandem::particles::test
