// Edges of meshes, identified by the positions of their ends: faces of one body may have separate vertices.
#pragma once

#include <algorithm>
#include <tuple>
#include <utility>

#include "common/math/vec3.hpp"

namespace tandem::launch {

// An edge between faces whose normals differ by more than 30 degrees is sharp.
inline constexpr double cos_sharp = 0.866;

using PointKey = std::tuple<double, double, double>;
using EdgeKey = std::pair<PointKey, PointKey>;

inline EdgeKey edge_key(Vec3d a, Vec3d b) {
  const PointKey first{a.x, a.y, a.z}, second{b.x, b.y, b.z};
  return std::minmax(first, second);
}

}  // namespace tandem::launch
