#include "common/geometry/coarse_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "common/geometry/mass_properties.hpp"
#include "common/geometry/solid_mesh.hpp"
#include "common/geometry/triangle_tree.hpp"

namespace tandem {
namespace {

double volume(const TriangleMesh& mesh) {
  return mass_of_mesh(mesh, 1).mass;
}

// A square in z = height of cells x cells quads, each of two triangles, but for a round hole of this radius.
TriangleMesh sheet(int cells, double height, double hole) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(cells + 1);
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i)
      mesh.vertices.push_back(
          {static_cast<double>(i) / cells - 0.5, static_cast<double>(j) / cells - 0.5, height});
  for (std::uint32_t j = 0; j + 1 < n; ++j)
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t a = j * n + i, b = a + 1, c = a + n, d = c + 1;
      const Vec3d middle = 0.5 * (mesh.vertices[a] + mesh.vertices[d]);
      if (std::hypot(middle.x, middle.y) < hole) continue;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += 0.5 *
           norm(cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]));
  return sum;
}

TEST(CoarseMesh, ABoxOfManyTrianglesHasTwelve) {
  const TriangleMesh fine = height_field_mesh(1, 2, std::vector(21, std::vector<double>(21, 0.5)), 0.0);
  const CoarseMesh coarse = coarsened(fine, 0.01);
  EXPECT_EQ(coarse.mesh.triangles.size(), 12u);
  EXPECT_NEAR(volume(coarse.mesh), 1, 1e-10);
  EXPECT_LT(coarse.deviation, 1e-7);
}

TEST(CoarseMesh, RoundSolidsKeepTheirVolumeWithinTheDeviation) {
  for (const double deviation : {0.0005, 0.002, 0.01}) {
    for (const TriangleMesh& fine :
         {cylinder_mesh(0.1, 0.2, 96), sphere_mesh(0.1, 64), cone_mesh(0.1, 0.02, 0.2, 96)}) {
      const CoarseMesh coarse = coarsened(fine, deviation);
      EXPECT_EQ(why_not_solid(coarse.mesh), "");
      EXPECT_LE(coarse.deviation, deviation);
      EXPECT_NEAR(volume(coarse.mesh), volume(fine), 1e-10 * volume(fine));
      std::printf("deviation %.2g mm: %zu triangles -> %zu, found %.2g mm\n", 1e3 * deviation,
                  fine.triangles.size(), coarse.mesh.triangles.size(), 1e3 * coarse.deviation);
      EXPECT_LT(coarse.mesh.triangles.size(), fine.triangles.size() / (deviation > 0.001 ? 2 : 1));
    }
  }
}

TEST(CoarseMesh, AHoleStaysWhatItIs) {
  const TriangleMesh fine = sheet(40, 0, 0.2);
  const CoarseMesh coarse = coarsened(fine, 0.01);
  EXPECT_NEAR(area(coarse.mesh), area(fine), 0.002);
  EXPECT_LE(coarse.deviation, 0.0105);
  EXPECT_LT(coarse.mesh.triangles.size(), fine.triangles.size() / 4);
}

// Two layers of a bent sheet, a fifth of the deviation apart.
TEST(CoarseMesh, SidesOfAThinSheetDoNotCross) {
  constexpr double deviation = 0.01, thickness = deviation / 5;
  TriangleMesh fine = sheet(40, 0, 0);
  for (Vec3d& v : fine.vertices) v.z = 0.2 * v.x * v.x + 0.1 * v.y * v.y;
  const auto n = static_cast<std::uint32_t>(fine.vertices.size());
  for (std::uint32_t v = 0; v < n; ++v) fine.vertices.push_back(fine.vertices[v] + Vec3d{0, 0, thickness});
  for (std::size_t t = fine.triangles.size(); t-- > 0;) {
    const auto [a, b, c] = fine.triangles[t];
    fine.triangles.push_back({a + n, b + n, c + n});
    fine.triangles[t] = {a, c, b};
  }
  const CoarseMesh coarse = coarsened(fine, deviation);
  EXPECT_LT(coarse.mesh.triangles.size(), fine.triangles.size() / 2);
  // Each triangle of the upper side is above those of the lower side.
  TriangleMesh lower;
  lower.vertices = coarse.mesh.vertices;
  for (const auto& t : coarse.mesh.triangles)
    if (cross(lower.vertices[t[1]] - lower.vertices[t[0]], lower.vertices[t[2]] - lower.vertices[t[0]]).z < 0)
      lower.triangles.push_back(t);
  const TriangleTree tree(lower);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(0, 1);
  double least = 1;
  for (const auto& t : coarse.mesh.triangles) {
    const Vec3d a = lower.vertices[t[0]], b = lower.vertices[t[1]], c = lower.vertices[t[2]];
    if (cross(b - a, c - a).z < 0) continue;
    for (int k = 0; k < 50; ++k) {
      const double u = part(random), v = part(random) * (1 - u);
      const Vec3d x = a + u * (b - a) + v * (c - a);
      const auto below = tree.nearest(x, 1);
      const auto& corners = lower.triangles[below->triangle];
      const Vec3d normal = cross(lower.vertices[corners[1]] - lower.vertices[corners[0]],
                                 lower.vertices[corners[2]] - lower.vertices[corners[0]]);
      least = std::min(least, -dot(x - below->point, normalized(normal)));
    }
  }
  EXPECT_GT(least, 0.2 * thickness);
}

// Triangles in another order, and a rough surface.
TEST(CoarseMesh, RoughSurfaceStaysWithinTheDeviation) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> rough(-1, 1);
  std::vector heights(40, std::vector<double>(40));
  for (auto& row : heights)
    for (double& h : row) h = 0.5 + 0.003 * rough(random);
  TriangleMesh fine = height_field_mesh(1, 1, heights, 0.0);
  for (const double deviation : {0.002, 0.01}) {
    const CoarseMesh coarse = coarsened(fine, deviation);
    std::shuffle(fine.triangles.begin(), fine.triangles.end(), random);
    const CoarseMesh other = coarsened(fine, deviation);
    for (const CoarseMesh& c : {coarse, other}) {
      EXPECT_EQ(why_not_solid(c.mesh), "");
      EXPECT_LE(c.deviation, deviation);
      EXPECT_NEAR(volume(c.mesh), volume(fine), 1e-10);
    }
    std::printf("deviation %g: %zu -> %zu and %zu, found %g\n", deviation, fine.triangles.size(),
                coarse.mesh.triangles.size(), other.mesh.triangles.size(), coarse.deviation);
  }
}

TEST(CoarseMesh, WhatIsNoSurfaceStays) {
  TriangleMesh three = sheet(4, 0, 0);  // and a third triangle at an edge
  three.vertices.push_back({0, 0, 0.3});
  three.triangles.push_back(
      {three.triangles[9][0], three.triangles[9][1], static_cast<std::uint32_t>(three.vertices.size() - 1)});
  const CoarseMesh coarse = coarsened(three, 0.01);
  EXPECT_NEAR(area(coarse.mesh), area(three), 1e-8);
  EXPECT_TRUE(coarsened({}, 0.01).mesh.triangles.empty());
}

}  // namespace
}  // namespace tandem
