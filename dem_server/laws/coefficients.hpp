// Numbers of a pair of materials from which a contact law computes its force, and how they follow from the
// sizes and masses of the two partners.
#pragma once

#include <type_traits>

#include "common/math/vec3.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/arithmetic.hpp"

namespace tandem::dem {

// Input of a contact law that depends on the two partners. Each law defines the units of its k_t and c_t.
template <class Real>
struct Coefficients {
  Real k_n = 0;       // F_n = k_n delta^(3/2) ... [N/m^1.5]
  Real c_n = 0;       // ... - c_n delta^(1/4) u_n [N s/m^1.25]
  Real k_t = 0;       // [N/m^1.5]
  Real c_t = 0;       // [N s/m^1.25]
  Real friction = 0;  // [-]
  // Inverse of the smaller radius: an overlap times this is its ratio to that radius [1/m]
  Real curvature = 0;
};

// Constants of two materials in contact. With `sized`, the coefficients depend on sizes and masses as in the
// laws of Hertz and Mindlin:
//   k_n = stiffness sqrt(R*),  c_n = damping sqrt(m* k_n),  k_t, c_t in proportion to them;
// without it (law `paper`) the four numbers are used as they are given.
template <class Real>
struct PairConstants {
  Coefficients<Real> c;
  bool sized = true;
};

template <class Real>
TANDEM_HD Coefficients<Real> coefficients(const PairConstants<Real>& pair, Real r_eff, Real m_eff,
                                          Real smaller_radius) {
  Coefficients<Real> c = pair.c;
  c.curvature = reciprocal(smaller_radius);
  if (pair.sized) {
    c.k_n = pair.c.k_n * root(r_eff);
    c.c_n = pair.c.c_n * root(m_eff * c.k_n);
    c.k_t = pair.c.k_t * c.k_n;
    c.c_t = pair.c.c_t * c.c_n;
  }
  return c;
}

// 1 / (1/a + 1/b); the result for (b, a) has the same bits.
template <class Real>
TANDEM_HD Real in_series(Real a, Real b) {
  const Real less = a < b ? a : b, more = a < b ? b : a;
  return less * quotient(more, a + b);
}

template <class Real>
TANDEM_HD Real sphere_mass(Real mass_per_volume, Real radius) {
  return mass_per_volume * radius * radius * radius;
}

// The coefficients of two spheres with these masses [kg] and radii [m].
template <class Real>
TANDEM_HD Coefficients<Real> coefficients_of_spheres(const PairConstants<Real>& pair, Real mass, Real radius,
                                                     Real other_mass, Real other_radius) {
  return coefficients(pair, in_series(radius, other_radius), in_series(mass, other_mass),
                      radius < other_radius ? radius : other_radius);
}

// R* of a sphere inside a hollow ball. In a closely fitting ball the contact area is wider than Hertz's law
// assumes, and the stability limit of the micro step assumes contacts that are not much stiffer than a
// contact with a plane. R* therefore stops growing at a ball of 4/3 of the sphere's radius.
inline constexpr int largest_fit = 4;  // R* / R
template <class Real>
TANDEM_HD Real radius_inside(Real radius, Real ball) {
  const Real room = ball - radius;
  return largest_fit * room > ball ? radius * quotient(ball, room) : largest_fit * radius;
}

template <class Real>
struct RollingConstants {
  Real friction = 0, damping = 0;  // mu_r, eta_r of laws/rolling.hpp [-]
};

// Constants of two materials in contact that only the generic variant uses.
template <class Real>
struct PairExtras {
  Real adhesion = 0;  // work of adhesion [J/m2] or cohesion energy density [J/m3]
  RollingConstants<Real> rolling;
  Real wear = 0;  // coefficient of Archard's law [-]
};

}  // namespace tandem::dem
