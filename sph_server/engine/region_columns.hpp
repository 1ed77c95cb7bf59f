// Lines against gravity through a closed mesh: where they are inside.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::sph {

// Where a line crosses the mesh, from below.
class ColumnCrossings {
 public:
  // Is the point at height z inside? Where the line crosses at z itself, what is `above` counts, or below.
  bool inside(double z, bool above = true) const {
    int number = 0;
    for (const Crossing& c : crossing_) {
      if (above ? c.z > z : c.z >= z) break;
      number += c.into;
    }
    return number > 0;
  }
  // Length of the part of the line that is inside and ends at height z; 0 where that is outside [m].
  double depth_below(double z) const {
    int number = 0;
    double low = z;
    for (const Crossing& c : crossing_) {
      if (c.z >= z) break;
      if (number <= 0) low = c.z;
      number += c.into;
    }
    return number > 0 ? z - low : 0;
  }

 private:
  friend class RegionColumns;
  struct Crossing {
    double z = 0;  // [m]
    int into = 0;  // by how much the winding number grows
  };
  std::vector<Crossing> crossing_;  // ascending
};

// A grid over the triangles as seen along the third axis. The sum of the crossings below a point is its
// winding number in a mesh that is closed up to it: a line through an edge or a corner counts the triangles
// that join there once.
class RegionColumns {
 public:
  // axis: three unit vectors at right angles. mesh: its normals outwards.
  RegionColumns(const TriangleMesh& mesh, const Vec3d* axis);

  Vec3d low() const { return low_; }  // bounds, along the axes [m]
  Vec3d high() const { return high_; }
  void find(double x, double y, ColumnCrossings& found) const;

 private:
  std::size_t cell(double x, double low, std::size_t cells) const;

  TriangleMesh mesh_;  // along the axes
  Vec3d low_, high_;
  double edge_ = 1;  // of a cell [m]
  std::size_t cells_[2] = {1, 1};
  std::vector<std::uint32_t> start_, triangle_;  // of each cell
};

}  // namespace tandem::sph
