// A box parallel to the axes around points.
#pragma once

#include <algorithm>
#include <limits>

#include "common/math/vec3.hpp"

namespace tandem {

// Empty until a point is added.
struct Bounds {
  static constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3d low{inf, inf, inf}, high{-inf, -inf, -inf};

  void add(Vec3d p, double radius = 0) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a] - radius);
      high[a] = std::max(high[a], p[a] + radius);
    }
  }
  // Whether both are nowhere farther apart than `distance`.
  bool overlaps(const Bounds& other, double distance = 0) const {
    for (int a = 0; a < 3; ++a)
      if (low[a] > other.high[a] + distance || other.low[a] > high[a] + distance) return false;
    return true;
  }
  Vec3d size() const { return high - low; }
  Vec3d middle() const { return 0.5 * (low + high); }
};

template <class Points>
Bounds bounds_of(const Points& points) {
  Bounds bounds;
  for (const Vec3d& p : points) bounds.add(p);
  return bounds;
}

}  // namespace tandem
