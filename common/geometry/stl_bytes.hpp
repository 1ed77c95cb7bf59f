// A mesh as the bytes of a binary STL file.
#pragma once

#include <string>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem {

// Corners are rounded to single precision, as the format wants. `mesh` has no triangle without area.
std::string stl_bytes(const TriangleMesh& mesh);

}  // namespace tandem
