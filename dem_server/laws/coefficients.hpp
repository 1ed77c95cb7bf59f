// The numbers of a pair of materials that a contact law computes with, and how they follow from sizes and
// masses.
#pragma once

#include <type_traits>

#include "common/math/vec3.hpp"
#include "dem_server/base/arithmetic.hpp"

namespace tandem::dem {

// What a contact law is given of the two partners. k_t and c_t are the law's own; see the law.
template <class Real>
struct Coefficients {
  Real k_n = 0;        // F_n = k_n delta^(3/2) ... [N/m^1.5]
  Real c_n = 0;        // ... - c_n delta^(1/4) u_n [N s/m^1.25]
  Real k_t = 0;        // [N/m^1.5]
  Real c_t = 0;        // [N s/m^1.25]
  Real friction = 0;   // [-]
  Real curvature = 0;  // inverse of the smaller radius: relates overlaps to it [1/m]
};

// Two materials that meet. Where `sized`, the coefficients depend on sizes and masses as Hertz and Mindlin
// say:
//   k_n = stiffness sqrt(R*),  c_n = damping sqrt(m* k_n),  k_t, c_t in proportion to them;
// else (law `paper`) the four are given as they are.
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

// 1 / (1/a + 1/b), the same to the bit for (b, a).
template <class Real>
TANDEM_HD Real in_series(Real a, Real b) {
  const Real less = a < b ? a : b, more = a < b ? b : a;
  return less * quotient(more, a + b);
}

// R* of a sphere inside a hollow ball. In a ball that fits it closely contacts are wider than Hertz's law is
// made for, and the stability of the micro step counts on contacts that are not much stiffer than those with
// a plane: from a ball of 4/3 of its radius down, R* is that of this ball.
inline constexpr int largest_fit = 4;  // R* / R
template <class Real>
TANDEM_HD Real radius_inside(Real radius, Real ball) {
  const Real room = ball - radius;
  return largest_fit * room > ball ? radius * quotient(ball, room) : largest_fit * radius;
}

template <class Real>
struct RollingConstants {
  Real friction = 0, damping = 0;  // mu_r, eta_r of laws/turning.hpp [-]
};

// Two materials that meet, for laws that the generic variant alone has.
template <class Real>
struct PairExtras {
  Real adhesion = 0;  // work of adhesion [J/m2] or cohesion energy density [J/m3]
  RollingConstants<Real> rolling;
};

}  // namespace tandem::dem
