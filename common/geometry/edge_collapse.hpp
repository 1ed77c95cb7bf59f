// A triangle mesh whose edges collapse into vertices.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem {

struct Triangle3 {
  Vec3d a, b, c;  // [m]
};

// Edge (kept, removed) becomes the vertex `kept` at another place.
struct EdgeCollapse {
  std::uint32_t kept = 0, removed = 0;
  Vec3d at;                           // [m]
  double cost = 0;                    // squares of swept volumes [m6]
  std::vector<std::uint32_t> before;  // triangles that have one of the two vertices
  std::vector<std::uint32_t> left;    // those of them that have not both
  std::vector<Triangle3> after;       // they, as they become; a is the new vertex
};

class CollapsibleMesh {
 public:
  // Triangles join where they share vertices.
  explicit CollapsibleMesh(const TriangleMesh& mesh);

  // Nothing where the surface around the edge would not stay what it is: open or closed, and of as many
  // parts [DeyEdelsbrunnerGuhaNekhayev1999]. The new vertex keeps the enclosed volume; beyond that it
  // minimises the squared volumes between the triangles and it, and the squared areas at open edges
  // [LindstromTurk1998].
  std::optional<EdgeCollapse> collapse_of(std::uint32_t v, std::uint32_t w) const;
  // Does no triangle turn over, or become a needle that is clearly narrower than those before?
  bool keeps_shape(const EdgeCollapse& collapse) const;
  void apply(const EdgeCollapse& collapse);

  // Ascending.
  std::vector<std::uint32_t> neighbours(std::uint32_t v) const;
  const std::vector<std::uint32_t>& triangles_of(std::uint32_t v) const { return of_vertex_[v]; }
  std::vector<std::uint32_t> triangles_between(std::uint32_t v, std::uint32_t w) const;
  bool is_at_open_edge(std::uint32_t v) const { return open_[v]; }
  bool is_flat_at(std::uint32_t v, std::uint32_t w) const;
  Vec3d area_vector(std::uint32_t triangle) const;  // twice the area along the normal [m2]
  Vec3d normal_at(std::uint32_t v) const;           // sum of them [m2]
  // Grows with each change at the vertex.
  std::uint64_t version(std::uint32_t v) const { return version_[v]; }
  // What is left.
  TriangleMesh mesh() const;

 private:
  bool has(std::uint32_t triangle, std::uint32_t v) const;
  bool is_manifold_at(std::uint32_t v) const;
  bool keeps_topology(std::uint32_t v, std::uint32_t w) const;
  void place(EdgeCollapse& collapse) const;

  std::vector<Vec3d> position_;
  std::vector<std::array<std::uint32_t, 3>> triangle_;
  std::vector<bool> removed_;                          // (triangles)
  std::vector<std::vector<std::uint32_t>> of_vertex_;  // triangles, ascending
  std::vector<bool> open_, fixed_;                     // (vertices)
  std::vector<std::uint64_t> version_;
};

}  // namespace tandem
