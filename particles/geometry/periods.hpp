// Directions in which the domain is periodic: what leaves through one face enters through the opposite one.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/math/vec3.hpp"
#include "common/scene/model.hpp"

namespace tandem::particles {

struct Periods {
  Vec3d min;     // where the domain begins [m]
  Vec3d length;  // period lengths, 0 along axes without period [m]

  TANDEM_HD bool any() const { return length.x > 0 || length.y > 0 || length.z > 0; }

  // x, moved into the domain by whole periods.
  TANDEM_HD Vec3d wrapped(Vec3d x) const {
    for (int a = 0; a < 3; ++a) {
      if (!(length[a] > 0)) continue;
      const double end = min[a] + length[a];
      if (x[a] >= min[a] && x[a] < end) continue;
      x[a] -= std::floor((x[a] - min[a]) / length[a]) * length[a];
      // Both ends are one position, and rounding may yield either.
      if (x[a] < min[a] || x[a] >= end) x[a] = min[a];
    }
    return x;
  }

  // The shortest of the vectors that differ from d by whole periods.
  TANDEM_HD Vec3d shortest(Vec3d d) const {
    for (int a = 0; a < 3; ++a)
      if (length[a] > 0) d[a] -= std::floor(d[a] / length[a] + 0.5) * length[a];
    return d;
  }
};

inline Periods periods_of(const scene::Dem& dem) {
  Periods p;
  p.min = dem.domain.min;
  for (int a = 0; a < 3; ++a)
    if (dem.periodic[static_cast<std::size_t>(a)]) p.length[a] = dem.domain.max[a] - dem.domain.min[a];
  return p;
}

// Which image of a neighbour is meant: along axis a it is one period above the domain (bit 2a), one period
// below it (bit 2a + 1), or in it.
using Image = std::uint8_t;
TANDEM_HD constexpr Image image_above(int axis) {
  return static_cast<Image>(1u << (2 * axis));
}
TANDEM_HD constexpr Image image_below(int axis) {
  return static_cast<Image>(2u << (2 * axis));
}

}  // namespace tandem::particles
