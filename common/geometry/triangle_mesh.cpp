#include "common/geometry/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tandem {

namespace {

bool is_open(const std::vector<std::string>& open, const char* face) {
  return std::find(open.begin(), open.end(), face) != open.end();
}

// Corners a, b, c, d counter-clockwise as seen from outside.
void add_quad(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

}  // namespace

TriangleMesh box_mesh(Vec3d size, const std::vector<std::string>& open) {
  TriangleMesh mesh;
  // Bit 0 of a corner's index is its side in x, bit 1 in y, bit 2 in z.
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back({(corner & 1 ? 0.5 : -0.5) * size.x, (corner & 2 ? 0.5 : -0.5) * size.y,
                             (corner & 4 ? 0.5 : -0.5) * size.z});
  if (!is_open(open, "-x")) add_quad(mesh, 0, 4, 6, 2);
  if (!is_open(open, "+x")) add_quad(mesh, 1, 3, 7, 5);
  if (!is_open(open, "-y")) add_quad(mesh, 0, 1, 5, 4);
  if (!is_open(open, "+y")) add_quad(mesh, 2, 6, 7, 3);
  if (!is_open(open, "-z")) add_quad(mesh, 0, 2, 3, 1);
  if (!is_open(open, "+z")) add_quad(mesh, 4, 5, 7, 6);
  return mesh;
}

TriangleMesh cylinder_mesh(double radius, double height, int segments, const std::vector<std::string>& open) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(segments);
  for (const double z : {-height / 2, height / 2})
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    add_quad(mesh, i, next, n + next, n + i);
  }
  const auto close = [&](double z, std::uint32_t ring, bool upward) {
    const auto centre = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back({0, 0, z});
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t here = ring + i, next = ring + (i + 1) % n;
      mesh.triangles.push_back({centre, upward ? here : next, upward ? next : here});
    }
  };
  if (!is_open(open, "-z")) close(-height / 2, 0, false);
  if (!is_open(open, "+z")) close(height / 2, n, true);
  return mesh;
}

TriangleMesh sphere_mesh(double radius, int segments) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(segments), zones = n / 2;
  for (std::uint32_t k = 1; k < zones; ++k)
    for (std::uint32_t i = 0; i < n; ++i) {
      const double polar = std::numbers::pi * k / zones, angle = 2 * std::numbers::pi * i / n;
      mesh.vertices.push_back({radius * std::sin(polar) * std::cos(angle),
                               radius * std::sin(polar) * std::sin(angle), radius * std::cos(polar)});
    }
  const auto top = static_cast<std::uint32_t>(mesh.vertices.size()), bottom = top + 1, last = top - n;
  mesh.vertices.push_back({0, 0, radius});
  mesh.vertices.push_back({0, 0, -radius});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({top, i, next});
    for (std::uint32_t ring = 0; ring < last; ring += n)
      add_quad(mesh, ring + i, ring + n + i, ring + n + next, ring + next);
    mesh.triangles.push_back({bottom, last + next, last + i});
  }
  return mesh;
}

TriangleMesh transformed(TriangleMesh mesh, const Pose& pose, double scale) {
  for (Vec3d& vertex : mesh.vertices) vertex = pose.p_WB + pose.q_WB.rotate(scale * vertex);
  return mesh;
}

std::vector<std::size_t> degenerate_triangles(const TriangleMesh& mesh) {
  std::vector<std::size_t> found;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [i, j, k] = mesh.triangles[t];
    const std::size_t count = mesh.vertices.size();
    bool usable = i < count && j < count && k < count;
    if (usable) {
      const Vec3d a = mesh.vertices[i], b = mesh.vertices[j], c = mesh.vertices[k];
      const double longest2 = std::max({norm2(b - a), norm2(c - b), norm2(a - c)});
      const double area = 0.5 * norm(cross(b - a, c - a));
      usable = is_finite(a) && is_finite(b) && is_finite(c) && longest2 > 0 && area >= 1e-12 * longest2;
    }
    if (!usable) found.push_back(t);
  }
  return found;
}

}  // namespace tandem
