// Which triangles of a mesh form one smooth surface.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::dem {

// Triangles that share an edge belong together when the surface bends there by at most this angle.
inline constexpr double smooth_angle = 25;  // [deg]

// Patch of each triangle (triangles), numbered from 0 in the order of their first triangles. Vertices at one
// place count as one, as STL repeats them. The winding of the triangles has no say: both sides of a wall are
// walls.
std::vector<std::uint32_t> smooth_patches(const TriangleMesh& mesh);

}  // namespace tandem::dem
