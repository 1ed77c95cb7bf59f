// Solids of triangles: hulls, meshes of cones and capsules, and the refusal of surfaces that enclose nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/geometry/convex_hull.hpp"
#include "common/geometry/mass_properties.hpp"
#include "common/geometry/solid_mesh.hpp"

namespace tandem {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TriangleMesh both(TriangleMesh a, const TriangleMesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + offset, j + offset, k + offset});
  return a;
}

TriangleMesh inverted(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  return mesh;
}

// Every point is on or below every face.
void expect_hull(const TriangleMesh& hull, const std::vector<Vec3d>& points, double tolerance) {
  ASSERT_EQ(why_not_solid(hull), "");
  for (const auto& [i, j, k] : hull.triangles) {
    const Vec3d a = hull.vertices[i];
    const Vec3d normal = normalized(cross(hull.vertices[j] - a, hull.vertices[k] - a));
    for (const Vec3d& p : points) ASSERT_LE(dot(normal, p - a), tolerance);
  }
}

TEST(ConvexHull, RandomPoints) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vec3d> points;
  for (int i = 0; i < 500; ++i) points.push_back({normal(random), normal(random), normal(random)});
  expect_hull(*convex_hull(points), points, 1e-9);
  for (Vec3d& p : points) p = normalized(p);
  const TriangleMesh sphere = *convex_hull(points);
  EXPECT_EQ(sphere.vertices.size(), points.size());
  EXPECT_EQ(sphere.triangles.size(), 2 * points.size() - 4);
  expect_hull(sphere, points, 1e-9);
}

// Thousands of points in six planes, many of them in line, and all of them twice.
TEST(ConvexHull, GridOfPoints) {
  std::vector<Vec3d> points;
  for (int i = 0; i <= 12; ++i)
    for (int j = 0; j <= 12; ++j)
      for (int k = 0; k <= 12; ++k) points.insert(points.end(), 2, {0.1 * i, 0.2 * j, 0.3 * k});
  const TriangleMesh hull = *convex_hull(points);
  expect_hull(hull, points, 1e-12);
  EXPECT_NEAR(mass_of_mesh(hull, 1).mass, 1.2 * 2.4 * 3.6, 1e-12);
}

TEST(ConvexHull, PointsInAPlaneHaveNone) {
  EXPECT_FALSE(convex_hull({}));
  EXPECT_FALSE(convex_hull({{1, 2, 3}}));
  EXPECT_FALSE(convex_hull({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}));
  EXPECT_FALSE(convex_hull({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}, {3, 4, 1}}));
  EXPECT_TRUE(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
}

TEST(Solids, OpenEdgesAreNamed) {
  EXPECT_EQ(why_not_solid(box_mesh({1, 2, 3})), "");
  EXPECT_THAT(why_not_solid(box_mesh({1, 2, 3}, {"+z"})),
              AllOf(HasSubstr("the edge from ["), HasSubstr("1.5]"), HasSubstr("the surface is open there")));
  TriangleMesh twisted = box_mesh({1, 1, 1});
  std::swap(twisted.triangles[0][0], twisted.triangles[0][1]);
  EXPECT_THAT(why_not_solid(twisted), HasSubstr("do not wind in pairs of opposite directions"));
  TriangleMesh flat = box_mesh({1, 1, 1}, {"-x", "+x", "-y", "+y", "-z"});
  flat = both(flat, inverted(flat));
  for (std::size_t t = 2; t < 4; ++t)
    for (auto& v : flat.triangles[t]) v -= 8;
  EXPECT_EQ(why_not_solid(flat), "the surface encloses no volume");
}

TEST(Solids, CavitiesWindTheOtherWay) {
  const TriangleMesh outer = box_mesh({1, 1, 1}), inner = box_mesh({0.5, 0.5, 0.5});
  EXPECT_THAT(why_not_solid(both(outer, inner)), HasSubstr("would count twice"));
  const TriangleMesh hollow = both(outer, inverted(inner));
  EXPECT_EQ(why_not_solid(hollow), "");
  EXPECT_NEAR(mass_of_mesh(hollow, 1000).mass, 875, 1e-9);
  EXPECT_EQ(why_not_solid(inverted(hollow)), "");
  const TriangleMesh beside = transformed(inner, {{3, 0, 0}, {}});
  EXPECT_EQ(why_not_solid(both(outer, beside)), "");
  EXPECT_THAT(why_not_solid(both(outer, inverted(beside))), HasSubstr("its volume would be negative"));
}

// A solid in a cavity winds as its outer solid does, whatever touches what.
TEST(Solids, TheDepthOfAPartSaysHowItWinds) {
  const TriangleMesh outer = box_mesh({1, 1, 1}), cavity = inverted(box_mesh({0.5, 0.5, 0.5})),
                     island = box_mesh({0.2, 0.2, 0.2});
  EXPECT_EQ(why_not_solid(both(both(outer, cavity), island)), "");
  EXPECT_THAT(why_not_solid(both(both(outer, cavity), inverted(island))),
              HasSubstr("winds as the cavity that it is inside of: its volume would be negative"));
  const auto moved = [](const TriangleMesh& mesh, Vec3d by) { return transformed(mesh, {by, {}}); };
  for (const Vec3d by : {Vec3d{0.25, 0, 0}, {0.25, 0.25, 0.25}}) {  // flush with a face, and in a corner
    EXPECT_EQ(why_not_solid(both(outer, moved(cavity, by))), "");
    EXPECT_THAT(why_not_solid(both(outer, moved(inverted(cavity), by))), HasSubstr("would count twice"));
  }
  // Sheets are thin beside their triangles.
  EXPECT_EQ(why_not_solid(both(outer, inverted(box_mesh({0.9, 0.9, 0.001})))), "");
  // Its bounds are within those of the ball, but two of its edges stick out.
  EXPECT_THAT(why_not_solid(both(sphere_mesh(1, 32), moved(cavity, {0.7, 0.7, 0}))),
              HasSubstr("is a cavity cannot be judged: it is partly inside the closed part at"));
}

TEST(Solids, WindingNumbers) {
  const TriangleMesh ball = sphere_mesh(1, 16);
  EXPECT_NEAR(winding_number(ball, {0.3, 0.2, -0.1}), 1, 1e-12);
  EXPECT_NEAR(winding_number(ball, {3, 2, -1}), 0, 1e-12);
  EXPECT_NEAR(winding_number(inverted(ball), {}), -1, 1e-12);
}

TEST(Solids, HeightFields) {
  const std::vector<std::vector<double>> heights{{0, 0.1, 0.2}, {0.1, 0.2, 0.1}};
  EXPECT_THAT(why_not_solid(height_field_mesh(2, 1, heights)), HasSubstr("the surface is open there"));
  const TriangleMesh solid = height_field_mesh(2, 1, heights, -1.0);
  EXPECT_EQ(why_not_solid(solid), "");
  EXPECT_GT(winding_number(solid, {0, 0, -0.5}), 0.99);
  EXPECT_TRUE(degenerate_triangles(solid).empty());
  EXPECT_EQ(solid.vertices[1], (Vec3d{0, -0.5, 0.1}));
}

// Area of the side of a pyramid's frustum of n sides: n trapezoids.
TEST(Solids, OpenConesAreTheirSides) {
  for (const int n : {4, 64}) {
    const double half = std::numbers::pi / n, low = 1, high = 0.25, height = 2;
    const double apothem = (low - high) * std::cos(half), across = (low + high) * std::sin(half);
    const auto area = [](const TriangleMesh& mesh) {
      double sum = 0;
      for (const auto& [a, b, c] : mesh.triangles)
        sum += 0.5 * norm(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
      return sum;
    };
    const double side = n * across * std::hypot(apothem, height),
                 top = 0.5 * n * high * high * std::sin(2 * half);
    EXPECT_NEAR(area(cone_mesh(low, high, height, n, {"+z", "-z"})) / side, 1, 1e-12);
    EXPECT_NEAR(area(cone_mesh(low, high, height, n, {"-z"})) / (side + top), 1, 1e-12);
    EXPECT_TRUE(degenerate_triangles(cone_mesh(low, 0, height, n, {"-z"})).empty());
    EXPECT_THAT(why_not_solid(cone_mesh(low, 0, height, n, {"-z"})), HasSubstr("the surface is open there"));
  }
}

TEST(Solids, RoundMeshesHaveNoTriangleWithoutArea) {
  for (const TriangleMesh& mesh :
       {cone_mesh(1, 0, 2, 3), cone_mesh(1, 0.5, 2, 64), capsule_mesh(1, 2, 3), capsule_mesh(1, 2, 64)}) {
    EXPECT_TRUE(degenerate_triangles(mesh).empty());
    EXPECT_EQ(why_not_solid(mesh), "");
    EXPECT_GT(winding_number(mesh, {}), 0.99);
  }
}

}  // namespace
}  // namespace tandem
