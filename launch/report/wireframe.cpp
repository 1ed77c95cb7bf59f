#include "launch/report/wireframe.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace tandem::launch {
namespace {

constexpr double cos_turn = 0.866;  // cos 30 deg

using PointKey = std::tuple<double, double, double>;
PointKey key_of(Vec3d p) {
  return {p.x, p.y, p.z};
}

struct Edge {
  Vec3d a, b, normal;  // normal of the first triangle [-]
  int triangles = 0;
  bool sharp = false;
};

}  // namespace

std::vector<std::pair<Vec3d, Vec3d>> feature_edges(const TriangleMesh& mesh) {
  // Faces of one body may have separate vertices, so that an edge is identified by its position.
  std::map<std::pair<PointKey, PointKey>, Edge> edges;
  for (const auto& triangle : mesh.triangles) {
    const Vec3d corner[3] = {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]],
                             mesh.vertices[triangle[2]]};
    const Vec3d area = cross(corner[1] - corner[0], corner[2] - corner[0]);
    if (norm2(area) == 0) continue;
    const Vec3d normal = normalized(area);
    for (int i = 0; i < 3; ++i) {
      const Vec3d a = corner[i], b = corner[(i + 1) % 3];
      Edge& edge = edges[std::minmax(key_of(a), key_of(b))];
      if (edge.triangles++ == 0) {
        edge = {a, b, normal, 1, false};
      } else if (dot(edge.normal, normal) < cos_turn) {
        edge.sharp = true;
      }
    }
  }
  std::vector<std::pair<Vec3d, Vec3d>> lines;
  for (const auto& [key, edge] : edges) {
    if (edge.sharp || edge.triangles == 1) lines.emplace_back(edge.a, edge.b);
  }
  return lines;
}

}  // namespace tandem::launch
