// Poses and boxes of parts.
#pragma once

#include <algorithm>

#include "common/geometry/bounds.hpp"
#include "common/math/rotation.hpp"

namespace tandem::launch {

inline Vec3d to_world(const Pose& pose, Vec3d p) {
  return pose.p_WB + pose.q_WB.rotate(p);
}

// What is in both, grown by `distance` on all sides.
inline Bounds common(const Bounds& a, const Bounds& b, double distance) {
  Bounds both;
  for (int k = 0; k < 3; ++k) {
    both.low[k] = std::max(a.low[k], b.low[k]) - distance;
    both.high[k] = std::min(a.high[k], b.high[k]) + distance;
  }
  return both;
}

}  // namespace tandem::launch
