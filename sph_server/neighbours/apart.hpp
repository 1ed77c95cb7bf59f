// The vector between two particles, from positions as neighbours read them.
#pragma once

#include "common/math/vec3.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/state/centre.hpp"

namespace tandem::sph {

template <class Real>
using Position = particles::PositionRadius<Real>;  // the radius is not used

// x_a - x_b [m], exact but for the rounding to Real of positions that are near each other: apart(b, a) has
// the opposite bits.
template <class Real>
struct Apart {
  using Unit = particles::LengthUnit<Real>;
  Unit unit;
  Vec3<typename Unit::Count> period;

  // image: of b.
  TANDEM_HD Vec3<Real> operator()(const Position<Real>& a, const Position<Real>& b,
                                  particles::Image image) const {
    Vec3<typename Unit::Count> d{Unit::minus(a.x, b.x), Unit::minus(a.y, b.y), Unit::minus(a.z, b.z)};
    if (image != 0) {
      for (int k = 0; k < 3; ++k) {
        if (image & particles::image_above(k)) d[k] = Unit::minus(d[k], period[k]);
        if (image & particles::image_below(k)) d[k] = Unit::minus(d[k], Unit::minus(0, period[k]));
      }
    }
    return {unit.metres(d.x), unit.metres(d.y), unit.metres(d.z)};
  }
};

template <class Real>
TANDEM_HD Position<Real> position_of(const particles::CentreUnit<Real>& centres, Vec3d x) {
  Position<Real> position;
  particles::FinePart<Real> fine{};
  centres.split(centres.of(x), position, fine);
  return position;
}

}  // namespace tandem::sph
