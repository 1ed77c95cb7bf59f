// The lines that a draughtsman would draw of a surface.
#pragma once

#include <utility>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

// Borders of the surface, and edges where it turns by more than 30 degrees; each once.
std::vector<std::pair<Vec3d, Vec3d>> feature_edges(const TriangleMesh& mesh);

}  // namespace tandem::launch
