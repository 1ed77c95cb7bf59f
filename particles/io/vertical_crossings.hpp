// Where a vertical line crosses a triangle mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::particles {

// A grid over the triangles as seen from above. A line through an edge or a corner crosses exactly one of the
// triangles that join there, so that the number of crossings tells inside from outside of a closed mesh.
class VerticalCrossings {
 public:
  explicit VerticalCrossings(TriangleMesh mesh);

  // Calls f(z) for each crossing of the line at (x, y), in no order.
  template <class F>
  void for_crossings(double x, double y, F f) const {
    const double column = (x - low_.x) / edge_, row = (y - low_.y) / edge_;
    if (!(column >= 0 && column < cells_[0] && row >= 0 && row < cells_[1])) return;
    const std::size_t cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(cells_[0]) +
                             static_cast<std::size_t>(column);
    for (std::uint32_t k = start_[cell]; k < start_[cell + 1]; ++k) {
      double z = 0;
      if (crosses(triangles_[k], x, y, z)) f(z);
    }
  }
  // Whether the number of crossings below a point is odd: it is then inside a closed mesh, or one that is
  // open above the point only.
  bool is_inside(Vec3d p) const {
    bool odd = false;
    for_crossings(p.x, p.y, [&](double z) { odd = odd != (z < p.z); });
    return odd;
  }
  Vec3d low() const { return low_; }
  Vec3d high() const { return high_; }
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  bool crosses(std::uint32_t triangle, double x, double y, double& z) const;

  TriangleMesh mesh_;
  Vec3d low_, high_;
  double edge_ = 1;  // of a cell [m]
  double cells_[2] = {0, 0};
  std::vector<std::uint32_t> start_, triangles_;
};

// Lowest point of the edges that do not belong to an even number of triangles; infinite where there are
// none: the mesh is closed.
double lowest_open_edge(const TriangleMesh& mesh);

}  // namespace tandem::particles
