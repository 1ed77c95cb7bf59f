// The edges of a triangle mesh, and the triangles at each.
#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch::mesh_repair {

using Vertex = std::uint32_t;
using Corners = std::array<Vertex, 3>;
using Edge = std::pair<Vertex, Vertex>;  // the lower vertex first

inline Edge edge_of(Vertex a, Vertex b) {
  return std::minmax(a, b);
}

inline std::map<Edge, std::vector<std::size_t>> triangles_at_edges(const TriangleMesh& mesh) {
  std::map<Edge, std::vector<std::size_t>> at;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      at[edge_of(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3])].push_back(t);
  return at;
}

}  // namespace tandem::launch::mesh_repair
