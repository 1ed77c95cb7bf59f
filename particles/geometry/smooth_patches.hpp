// Which triangles of a mesh form one smooth surface.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::particles {

// Triangles that share an edge belong to one patch when the surface bends there by at most this angle.
inline constexpr double smooth_angle = 25;  // [deg]

// Patch of each triangle (triangles), numbered from 0 in the order of their first triangles. Vertices at one
// position count as one, because STL repeats them. The winding of the triangles does not matter, because both
// sides of a triangle are walls.
std::vector<std::uint32_t> smooth_patches(const TriangleMesh& mesh);

}  // namespace tandem::particles
