#include "launch/mesh_tools/fill_openings.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "launch/mesh_tools/mesh_edges.hpp"

namespace tandem::launch::mesh_repair {
namespace openings {

// 4 area / length, as MeshFacts says.
double width_of(const TriangleMesh& mesh, const std::vector<Vertex>& loop) {
  Vec3d area;
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3d a = mesh.vertices[loop[i]], b = mesh.vertices[loop[(i + 1) % loop.size()]];
    area = area + 0.5 * cross(a - mesh.vertices[loop[0]], b - mesh.vertices[loop[0]]);
    length += norm(b - a);
  }
  return 4 * norm(area) / length;
}

void fill(TriangleMesh& mesh, const std::vector<Vertex>& loop) {
  const auto add = [&](Vertex a, Vertex b, Vertex c) { mesh.triangles.push_back({a, b, c}); };
  if (loop.size() == 3) return add(loop[0], loop[1], loop[2]);
  Vec3d middle;
  for (const Vertex v : loop) middle = middle + (1.0 / static_cast<double>(loop.size())) * mesh.vertices[v];
  const auto centre = static_cast<Vertex>(mesh.vertices.size());
  mesh.vertices.push_back(middle);
  for (std::size_t i = 0; i < loop.size(); ++i) add(loop[i], loop[(i + 1) % loop.size()], centre);
}

}  // namespace openings

FilledOpenings fill_openings(TriangleMesh& mesh, std::vector<std::size_t>& part, double widest) {
  // Open edges, against the direction of their triangle, with its part.
  std::map<Vertex, std::vector<std::pair<Vertex, std::size_t>>> next;
  for (const auto& [edge, triangles] : triangles_at_edges(mesh)) {
    if (triangles.size() != 1) continue;
    const Corners& t = mesh.triangles[triangles.front()];
    for (std::size_t i = 0; i < 3; ++i)
      if (edge_of(t[i], t[(i + 1) % 3]) == edge)
        next[t[(i + 1) % 3]].emplace_back(t[i], part[triangles.front()]);
  }
  FilledOpenings result;
  while (!next.empty()) {
    std::vector<Vertex> path{next.begin()->first};
    std::size_t own_part = 0;
    std::optional<std::vector<Vertex>> loop;
    while (!loop) {
      const auto at = next.find(path.back());
      if (at == next.end()) break;  // the open edges do not close: three triangles meet there
      const auto [to, of] = at->second.back();
      own_part = of;
      at->second.pop_back();
      if (at->second.empty()) next.erase(at);
      if (const auto begin = std::ranges::find(path, to); begin != path.end())
        loop = std::vector<Vertex>(begin, path.end());
      else
        path.push_back(to);
    }
    if (!loop || loop->size() < 3) {
      ++result.left;
      continue;
    }
    // What of the path is before the loop is put back.
    for (std::size_t i = 0; i + loop->size() < path.size(); ++i)
      next[path[i]].emplace_back(path[i + 1], own_part);
    const double width = openings::width_of(mesh, *loop);
    if (width > widest) {
      ++result.left;
      continue;
    }
    openings::fill(mesh, *loop);
    part.resize(mesh.triangles.size(), own_part);
    result.widest = std::max(result.widest, width);
    ++result.filled;
  }
  return result;
}

}  // namespace tandem::launch::mesh_repair
