// Input and output of a contact law. A law is a pure functor: it takes and returns values, and has neither
// pointers nor state. Loads, stores and sums belong to the loop (contact/pair_forces.hpp).
//
// Conventions: i is the sphere that owns the contact, j the other sphere or the wall. n is the unit normal
// from j to i. u is the velocity of i relative to j at the contact point. Every formula is odd under
// exchanging i and j, and the build forbids fused multiply-add; the force that j computes is therefore the
// exact negative of the force that i computes.
#pragma once

#include "common/math/vec3.hpp"

namespace tandem::dem {

template <class Real>
struct Contact {
  Vec3<Real> n;              // normal, j to i [-]
  Real overlap = 0;          // delta > 0 [m]
  Real normal_speed = 0;     // u . n, negative while approaching [m/s]
  Vec3<Real> slip;           // u - (u . n) n [m/s]
  Real dt = 0;               // micro step [s]
  Real normal_rotation = 0;  // rotation about n since the last micro step, the mean of i and j [rad]

  // Only the generic variant sets these.
  Real r_eff = 0;     // R* = 1 / (1/R_i + 1/R_j) [m]
  Real m_eff = 0;     // m*, likewise [kg]
  Real adhesion = 0;  // jkr: work of adhesion [J/m2]; sjkr: cohesion energy density [J/m3]
};

template <class Real>
struct ContactForce {
  Real normal = 0;        // along n on i [N]
  Vec3<Real> tangential;  // on i [N]

  // Only rolling, twisting and the sums of dissipated energy read these.
  Real elastic_force = 0;  // Coulomb's limit is mu times this [N]
  Real k_n = 0, k_t = 0;   // secant stiffnesses [N/m]
  Real c_t = 0;            // tangential damping [N s/m]
  Real hertz_overlap = 0;  // squared contact radius / R* [m]
  // Values of one micro step ago where they have grown since, otherwise the present ones. The stiffnesses are
  // squares of secant stiffnesses, of which only the ratio has a meaning.
  Real previous_hertz_overlap = 0, previous_stiffness2 = 1, current_stiffness2 = 1;
};

// The overlap one micro step ago where it has grown since, otherwise the present one, for contacts without
// adhesion [m]. The present velocity yields it, because leapfrog has moved the spheres with that velocity.
template <class Real>
TANDEM_HD Real previous_overlap(const Contact<Real>& c) {
  const Real before = c.overlap + c.dt * c.normal_speed;
  const Real from = before > 0 ? before : Real(0);
  return from < c.overlap ? from : c.overlap;
}

}  // namespace tandem::dem
