// What a contact law is given and what it answers. A law is a pure functor: values in, values out; no
// pointers, no memory of its own. Loads, stores and sums belong to the loop (contact/pair_forces.hpp).
//
// Conventions: i is the sphere that owns the contact, j the other sphere or the wall. n is the unit normal
// from j to i. u is the velocity of i relative to j at the contact point. Every formula is odd under
// exchanging i and j and the build forbids fused multiply-add, so the force that j computes is the exact
// negative of the force that i computes.
#pragma once

#include "dem_server/model/parameters.hpp"

namespace tandem::dem {

template <class Real>
struct Contact {
  Vec3<Real> n;           // normal, j to i [-]
  Real overlap = 0;       // delta > 0 [m]
  Real normal_speed = 0;  // u . n, negative while approaching [m/s]
  Vec3<Real> slip;        // u - (u . n) n [m/s]
  Real dt = 0;            // micro step [s]
};

template <class Real>
struct ContactForce {
  Real normal = 0;        // along n on i [N]
  Vec3<Real> tangential;  // on i [N]
};

// The tangential spring of one contact.
template <class Real>
struct alignas(16) History {
  Vec3<Real> spring;        // elastic tangential displacement of i relative to j [m]
  std::uint32_t stamp = 0;  // micro step of the last contact; an older one is no history
};

// The spring turned with the contact plane: its normal part goes, and its squared length becomes part/whole
// of what it was.
template <class Real>
TANDEM_HD Vec3<Real> turned(Vec3<Real> spring, Vec3<Real> n, Real part = 1, Real whole = 1) {
  const Real length2 = norm2(spring);
  spring -= dot(spring, n) * n;
  const Real divisor = whole * norm2(spring);
  if (divisor > 0) spring *= std::sqrt(part * length2 / divisor);
  return spring;
}

}  // namespace tandem::dem
