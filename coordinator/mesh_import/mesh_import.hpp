// Reads a mesh file, STL (binary or ASCII) or OBJ, into triangles.
#pragma once

#include <filesystem>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

// Corners at the same place become one vertex, so that neighbours share edges; polygons are divided into
// triangles. Coordinates are multiplied by `scale` (metres per unit of the file). Throws Error{scene} that
// names the file where it cannot be read, has no triangle, or has triangles without area.
TriangleMesh import_mesh(const std::filesystem::path& file, double scale);

}  // namespace tandem::launch
