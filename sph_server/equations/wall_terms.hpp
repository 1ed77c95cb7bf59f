// What a facet of a wall does to a particle. Behind the facet the liquid continues as ghost liquid: its
// pressure is p_i plus the hydrostatic difference, its velocity is mirrored at the wall, so that the velocity
// of the wall is the mean of both. All integrals over the ghost liquid are exact
// (kernel/facet_integrals.hpp).
#pragma once

#include "common/math/vec3.hpp"
#include "sph_server/equations/liquid.hpp"
#include "sph_server/equations/pair_terms.hpp"
#include "sph_server/kernel/facet_integrals.hpp"

namespace tandem::sph {

struct WallTerms {
  Vec3d pressure;         // acceleration by the pressure p_i of particle and ghost [m/s2]
  Vec3d hydrostatic;      // by the hydrostatic difference [m/s2]
  Vec3d viscous;          // [m/s2]
  double continuity = 0;  // rate of compression by motion, divided by 1 + e [1/s]

  Vec3d total() const { return pressure + hydrostatic + viscous; }
};

struct WallConstants {
  double inverse_mass = 0;  // [1/kg]
  double viscous = 0;       // 2 mu for walls without slip, 0 for walls with free slip [Pa s]
  double nearest = 0;       // distance below which the velocity of the ghost grows no further [m]
  Vec3d weight;             // rho0 g [Pa/m]

  static WallConstants of(const Liquid& l, bool slip) {
    return {1 / l.mass(), slip ? 0 : 2 * l.viscosity, 0.25 * l.spacing, l.density * l.gravity};
  }
};

// n: normal of the facet towards the particle; distance: from its plane; v: of the particle relative to the
// wall. With the integrals S, Y, B of the facet:
//   pressure     V 2 p_i S n
//   hydrostatic  V (n (rho0 g . Y) - B rho0 g): the integral of rho0 g . (y - x) grad W over the shadow
//   viscosity    -V 2 mu S v_t / distance: Morris' form, integrated over a ghost with linear velocity
//   continuity   -2 S v . n
TANDEM_HD inline WallTerms wall_terms(const WallConstants& c, const FacetIntegrals& f, Vec3d n,
                                      double distance, Vec3d v, double pressure, double volume) {
  const double by_mass = volume * c.inverse_mass, across = dot(v, n);
  WallTerms t;
  t.pressure = (by_mass * 2 * pressure * f.surface) * n;
  t.hydrostatic = by_mass * (dot(c.weight, f.moment) * n - f.shadow * c.weight);
  const double gap = distance > c.nearest ? distance : c.nearest;
  t.viscous = (-by_mass * c.viscous * f.surface / gap) * (v - across * n);
  t.continuity = -2 * across * f.surface;
  return t;
}

}  // namespace tandem::sph
