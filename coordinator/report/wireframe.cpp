#include "coordinator/report/wireframe.hpp"

#include <map>

#include "coordinator/report/edge_key.hpp"

namespace tandem::launch {
namespace {

struct Edge {
  Vec3d a, b, normal;  // normal of the first triangle [-]
  int triangles = 0;
  bool sharp = false;
};

}  // namespace

std::vector<std::pair<Vec3d, Vec3d>> feature_edges(const TriangleMesh& mesh) {
  std::map<EdgeKey, Edge> edges;
  for (const auto& triangle : mesh.triangles) {
    const Vec3d corner[3] = {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]],
                             mesh.vertices[triangle[2]]};
    const Vec3d area = cross(corner[1] - corner[0], corner[2] - corner[0]);
    if (norm2(area) == 0) continue;
    const Vec3d normal = normalized(area);
    for (int i = 0; i < 3; ++i) {
      const Vec3d a = corner[i], b = corner[(i + 1) % 3];
      Edge& edge = edges[edge_key(a, b)];
      if (edge.triangles++ == 0) {
        edge = {a, b, normal, 1, false};
      } else if (dot(edge.normal, normal) < cos_sharp) {
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
