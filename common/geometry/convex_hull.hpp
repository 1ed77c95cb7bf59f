// The convex hull of points in space.
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem {

// Quickhull [Barber1996] with exact predicates: which points are corners, and which of them share a face, is
// decided on a grid of 2^-39 of the largest extent, so that points in one plane and points given twice are no
// special case. Corners keep their coordinates. Faces are triangles, wound counter-clockwise as seen from
// outside. Absent where the points lie in one plane of that grid.
std::optional<TriangleMesh> convex_hull(const std::vector<Vec3d>& points);

}  // namespace tandem
