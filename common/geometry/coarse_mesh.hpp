// Meshes with fewer triangles, within a stated distance of the surface that they stand for.
#pragma once

#include "common/geometry/triangle_mesh.hpp"

namespace tandem {

struct CoarseMesh {
  TriangleMesh mesh;
  double deviation = 0;  // largest distance found between the two surfaces, from each to the other [m]
};

// Collapses edges while every point of either surface stays within `deviation` [m] of the other one, and
// places new vertices such that the enclosed volume stays what it is [LindstromTurk1998]. Open edges move by
// a fifth of that at most. Surfaces that face each other, as those of a sheet with a thickness or of a narrow
// gap, move by a quarter of their distance at most. Vertices at edges of three or more triangles stay.
// Vertices less than 1e-5 of the deviation apart are one. A mesh with a triangle without area is returned as
// it is. The result depends on the mesh alone, not on the host.
CoarseMesh coarsened(const TriangleMesh& mesh, double deviation);

}  // namespace tandem
