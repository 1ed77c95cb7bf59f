// Points on a triangle.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/vec3.hpp"

namespace tandem::sph {

// Calls each(x) at points of a triangle that are less than `apart` from each other [m].
template <class Each>
void for_points(Vec3d a, Vec3d b, Vec3d c, double apart, Each each) {
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  const int n = std::max(1, static_cast<int>(std::ceil(longest / apart)));
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) each(a + ((i + 1.0 / 3) / n) * (b - a) + ((j + 1.0 / 3) / n) * (c - a));
}

}  // namespace tandem::sph
