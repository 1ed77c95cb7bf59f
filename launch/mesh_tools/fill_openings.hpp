// Fills the openings of a triangle mesh.
#pragma once

#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch::mesh_repair {

struct FilledOpenings {
  std::size_t filled = 0, left = 0;
  double widest = 0;  // of those that are filled [m]
};

// Fills loops of open edges up to `widest` wide [m] by triangles about their middle. `part` has the number of
// the part of each triangle, also of the new ones.
FilledOpenings fill_openings(TriangleMesh& mesh, std::vector<std::size_t>& part, double widest);

}  // namespace tandem::launch::mesh_repair
