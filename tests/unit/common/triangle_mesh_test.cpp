#include "common/geometry/triangle_mesh.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <numbers>

namespace tandem {
namespace {

// Signed volume by the divergence theorem: positive when the triangles wind outward.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    sum += dot(mesh.vertices[i], cross(mesh.vertices[j], mesh.vertices[k])) / 6;
  return sum;
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    sum += norm(cross(mesh.vertices[j] - mesh.vertices[i], mesh.vertices[k] - mesh.vertices[i])) / 2;
  return sum;
}

// In a closed surface of uniform winding every edge is traversed once in each direction. Returns the number
// of edges without a partner.
int open_edges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
  for (const auto& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      ++count[{t[i], t[(i + 1) % 3]}];
      --count[{t[(i + 1) % 3], t[i]}];
    }
  int open = 0;
  for (const auto& [edge, n] : count) open += n > 0 ? n : 0;
  return open;
}

TEST(BoxMesh, IsClosedAndFacesOutward) {
  const TriangleMesh mesh = box_mesh({1, 2, 3});
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_NEAR(volume(mesh), 6, 1e-14);
  EXPECT_NEAR(area(mesh), 22, 1e-14);
  EXPECT_EQ(open_edges(mesh), 0);
}

TEST(BoxMesh, LeavesOutOpenFaces) {
  const char* const faces[] = {"-x", "+x", "-y", "+y", "-z", "+z"};
  const Vec3d normals[] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  for (int f = 0; f < 6; ++f) {
    const TriangleMesh mesh = box_mesh({2, 2, 2}, {faces[f]});
    EXPECT_EQ(mesh.triangles.size(), 10u);
    EXPECT_EQ(open_edges(mesh), 4);
    for (const auto& [i, j, k] : mesh.triangles) {
      const Vec3d n = cross(mesh.vertices[j] - mesh.vertices[i], mesh.vertices[k] - mesh.vertices[i]);
      EXPECT_LT(dot(n, normals[f]), 1e-12) << faces[f];
    }
  }
  EXPECT_TRUE(box_mesh({1, 1, 1}, {"-x", "+x", "-y", "+y", "-z", "+z"}).triangles.empty());
}

TEST(CylinderMesh, IsTheInscribedPrism) {
  const int n = 16;
  const TriangleMesh mesh = cylinder_mesh(2, 3, n);
  const double polygon = n / 2.0 * 4 * std::sin(2 * std::numbers::pi / n);
  EXPECT_EQ(mesh.triangles.size(), 4u * n);
  EXPECT_NEAR(volume(mesh), polygon * 3, 1e-12);
  EXPECT_EQ(open_edges(mesh), 0);
}

TEST(CylinderMesh, LeavesOutOpenEnds) {
  EXPECT_EQ(cylinder_mesh(1, 1, 8, {"+z"}).triangles.size(), 24u);
  EXPECT_EQ(open_edges(cylinder_mesh(1, 1, 8, {"+z"})), 8);
  EXPECT_EQ(cylinder_mesh(1, 1, 8, {"+z", "-z"}).triangles.size(), 16u);
  for (const Vec3d& v : cylinder_mesh(1, 1, 8, {"-z"}).vertices) EXPECT_LE(norm(v), std::sqrt(1.25) + 1e-15);
}

TEST(SphereMesh, IsClosedAndComesNearToTheSphere) {
  const TriangleMesh mesh = sphere_mesh(2, 64);
  EXPECT_EQ(open_edges(mesh), 0);
  EXPECT_TRUE(degenerate_triangles(mesh).empty());
  EXPECT_NEAR(volume(mesh), 4.0 / 3 * std::numbers::pi * 8, 0.01 * volume(mesh));  // wound outwards: positive
  for (const Vec3d& v : mesh.vertices) EXPECT_NEAR(norm(v), 2, 1e-15);
}

TEST(Transformed, ScalesThenTurnsThenMoves) {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}};
  const Pose pose{{10, 0, 0}, exp({0, 0, std::numbers::pi / 2})};
  const Vec3d v = transformed(mesh, pose, 2).vertices[0];
  EXPECT_NEAR(v.x, 10, 1e-14);
  EXPECT_NEAR(v.y, 2, 1e-14);
  EXPECT_EQ(v.z, 0);
}

TEST(DegenerateTriangles, FindsEachKind) {
  TriangleMesh mesh;
  mesh.vertices = {
      {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 1}, {0, 1, 3}, {0, 1, 4}, {0, 1, 9}, {2, 2, 2}};
  EXPECT_EQ(degenerate_triangles(mesh), (std::vector<std::size_t>{1, 2, 3, 4, 5}));
}

TEST(DegenerateTriangles, SizeDoesNotMatter) {
  for (const double scale : {1e-9, 1.0, 1e6})
    EXPECT_TRUE(degenerate_triangles(transformed(box_mesh({1, 1e-6, 1}), {}, scale)).empty()) << scale;
}

}  // namespace
}  // namespace tandem
