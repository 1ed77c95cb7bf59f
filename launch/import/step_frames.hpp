// Poses and boxes of parts.
#pragma once

#include <algorithm>
#include <limits>

#include "common/math/rotation.hpp"

namespace tandem::launch {

inline Vec3d to_world(const Pose& pose, Vec3d p) {
  return pose.p_WB + pose.q_WB.rotate(p);
}

struct Bounds {
  static constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3d low{inf, inf, inf}, high{-inf, -inf, -inf};

  void add(Vec3d p) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  bool meets(const Bounds& other, double distance) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] > other.high[k] + distance || other.low[k] > high[k] + distance) return false;
    return true;
  }
  // What is in both, grown by `distance` on all sides.
  Bounds common(const Bounds& other, double distance) const {
    Bounds both;
    for (int k = 0; k < 3; ++k) {
      both.low[k] = std::max(low[k], other.low[k]) - distance;
      both.high[k] = std::min(high[k], other.high[k]) + distance;
    }
    return both;
  }
};

}  // namespace tandem::launch
