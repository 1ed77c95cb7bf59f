// The free sides of a surface as seen from above.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::particles {

// Edges of a mesh, in x and y, beyond which there is none of it. An edge of which some other part of the mesh
// covers a part counts whole.
class PlanOutline {
 public:
  PlanOutline() = default;
  // `covers`: whether some of the mesh is at x and y. `reach`: the largest radius of a sphere [m]. Without
  // edges where the outline is a box along x and y.
  PlanOutline(const TriangleMesh& mesh, const std::function<bool(double x, double y)>& covers, double reach);

  bool is_box() const { return edges_.empty(); }
  // Moves a sphere, which the mesh `covers` or not, so that it does not reach beyond the nearest edge.
  Vec3d moved_inside(Vec3d p, double radius, bool is_covered) const;

 private:
  struct Edge {
    Vec3d from, to, inwards;  // z is 0
  };
  struct Nearest {
    double distance;
    Vec3d point, inwards;
  };
  Nearest nearest(Vec3d p) const;
  void make_cells(double reach);

  std::vector<Edge> edges_;
  Vec3d low_, high_;
  std::vector<std::vector<std::uint32_t>> near_;  // edges in reach of each cell, in rows along x
};

}  // namespace tandem::particles
