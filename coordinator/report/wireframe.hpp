// The visible edges of a surface.
#pragma once

#include <utility>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

// Open edges of the surface, and edges between faces at more than 30 degrees; each once.
std::vector<std::pair<Vec3d, Vec3d>> feature_edges(const TriangleMesh& mesh);

}  // namespace tandem::launch
