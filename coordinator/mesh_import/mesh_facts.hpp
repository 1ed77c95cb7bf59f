// Properties of a triangle mesh as a surface: its size, and its openings.
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

// A loop of open edges: the rim of an opening, intended or not.
struct Opening {
  std::size_t edges = 0;
  double length = 0;  // of its edges [m]
  double extent = 0;  // diagonal of its bounding box [m]
  // 4 area / length [m]: the diameter of the inscribed circle of a triangle, a square, a disc.
  double width = 0;
  Vec3d at;  // one of its corners [m]
};

struct MeshFacts {
  Vec3d min, max;  // bounding box [m]
  std::size_t triangles = 0;
  double area = 0;                     // [m2]
  std::size_t open_edges = 0;          // edges of one triangle only
  std::size_t non_manifold_edges = 0;  // edges of more than two triangles
  std::size_t inverted_edges = 0;      // between two triangles of opposite winding
  std::vector<Opening> openings;       // widest first
  // Edges that would be open, but coincide with others whose ends are at most 1e-5 of the mesh's diagonal
  // away: corners that should be one are two. They do not count as open.
  std::size_t unjoined_edges = 0;
  double widest_gap = 0;  // between such corners [m]
  Vec3d unjoined_at;      // one of them [m]
  // By the divergence theorem, positive where the winding is counter-clockwise as seen from outside [m3].
  // Absent unless the surface is closed with uniform winding.
  std::optional<double> volume;

  Vec3d size() const { return max - min; }
  double diagonal() const { return norm(size()); }
};

// Takes linear time: edges are sorted by their lower vertex. `mesh` has at least one triangle, and
// neighbouring triangles share vertices.
MeshFacts facts_of(const TriangleMesh& mesh);

}  // namespace tandem::launch
