// A mesh as its file has it, with what import_mesh() refuses.
#pragma once

#include <filesystem>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

// As import_mesh(), but triangles without area stay. Throws Error{scene} where the file cannot be read or has
// no triangle.
TriangleMesh read_raw_mesh(const std::filesystem::path& file, double scale);

}  // namespace tandem::launch
