// Shifting of particles. A flow that stretches the liquid moves its particles onto lines, with gaps between
// them. Each particle therefore moves, besides with the liquid, along the gradient of the concentration of
// particles towards gaps [Lind2012, Sun2019]:
//   u = -C s R^2 sum V_j (1 + 0.2 (W / W(spacing))^4) grad W
// The rate s = sum V_j |(v_i - v_j) . grad W| is that of the deformation of the liquid: neither a liquid at
// rest nor one that turns rigidly is shifted, and the shift does not depend on the speed of the observer.
// Velocities are not changed by the shift, so that the momentum is kept exactly.
#pragma once

#include <cmath>

#include "sph_server/equations/pair_terms.hpp"

namespace tandem::sph {

// Filled part of the kernel below which a particle is at a free surface, and above which it is inside [-].
inline constexpr double shift_begins = 0.955, shift_is_whole = 0.985;

template <class Real, bool shifting>
struct Crowding {};

template <class Real>
struct Crowding<Real, true> {
  Vec3<Real> gradient;   // of the concentration of particles, with the factor above [1/m]
  Real deformation = 0;  // s [1/s]

  // volume: of the neighbour.
  TANDEM_HD void add(const PairConstants<Real>& c, Vec3<Real> d, const PairTerms<Real>& t, Real volume) {
    using std::fabs;
    const Real ratio = t.kernel * c.inverse_near, ratio2 = ratio * ratio;
    const Real factor = 1 + static_cast<Real>(0.2) * (ratio2 * ratio2);
    gradient += (volume * t.gradient * factor) * d;
    deformation += fabs(t.continuity);
  }
};

// Velocity of the shift [m/s]. surface: sum over the facets of S n, the part of the ghosts. Near a free
// surface, where the kernel is not filled, there is no shift: the gradient is that of the surface.
template <class Real>
TANDEM_HD Vec3<Real> shift_velocity(const Liquid& l, const Crowding<Real, true>& crowding, Vec3d surface,
                                    double filled) {
  const double R = l.support();
  const double inside = (filled - shift_begins) / (shift_is_whole - shift_begins);
  if (!(inside > 0)) return {};
  const double part = inside < 1 ? inside : 1;
  const Vec3d gradient = crowding.gradient.template as<double>() - surface;
  return ((-part * l.shifting * static_cast<double>(crowding.deformation) * R * R) * gradient)
      .template as<Real>();
}

}  // namespace tandem::sph
