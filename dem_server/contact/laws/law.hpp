// What a contact law is given and what it answers. A law is a pure functor: values in, values out; no
// pointers, no memory of its own. Loads, stores and sums belong to the loop (contact/pair_forces.hpp).
//
// Conventions: i is the sphere that owns the contact, j the other sphere or the wall. n is the unit normal
// from j to i. u is the velocity of i relative to j at the contact point. Every formula is odd under
// exchanging i and j and the build forbids fused multiply-add, so the force that j computes is the exact
// negative of the force that i computes.
#pragma once

#include "dem_server/core/arithmetic.hpp"
#include "dem_server/model/parameters.hpp"

namespace tandem::dem {

template <class Real>
struct Contact {
  Vec3<Real> n;           // normal, j to i [-]
  Real overlap = 0;       // delta > 0 [m]
  Real normal_speed = 0;  // u . n, negative while approaching [m/s]
  Vec3<Real> slip;        // u - (u . n) n [m/s]
  Real dt = 0;            // micro step [s]
  Real turn = 0;          // about n since the last micro step, the mean of i and j [rad]

  // For laws that the generic variant alone has; the others' loops leave them out.
  Real r_eff = 0;     // R* = 1 / (1/R_i + 1/R_j) [m]
  Real m_eff = 0;     // m*, likewise [kg]
  Real adhesion = 0;  // jkr: work of adhesion [J/m2]; sjkr: cohesion energy density [J/m3]
};

template <class Real>
struct ContactForce {
  Real normal = 0;        // along n on i [N]
  Vec3<Real> tangential;  // on i [N]

  // What rolling and twisting depend on; nothing else reads them.
  Real pressure = 0;      // what Coulomb's limit is mu times of [N]
  Real k_n = 0, k_t = 0;  // secant stiffnesses [N/m]
  Real c_t = 0;           // tangential damping [N s/m]
  Real spread = 0;        // squared contact radius / R* [m]
  // A micro step ago, where they have grown since, else now: spread, and, as part of a whole, the square of
  // the secant stiffnesses.
  Real spread_was = 0, part = 1, whole = 1;
};

// The tangential spring of a contact with a wall.
template <class Real>
struct alignas(16) History {
  Vec3<Real> spring;        // elastic tangential displacement of i relative to j [m]
  std::uint32_t stamp = 0;  // micro step of the last contact; an older one is no history
};

// Rotation of one contact, where the scene has rolling or twisting. It is as old as the spring beside it.
template <class Real>
struct alignas(4 * sizeof(Real)) Turn {
  Vec3<Real> rolled;  // relative angle across n [rad]
  Real twisted = 0;   // about n [rad]
};

// The overlap a micro step ago where it has grown since, else that of now, for contacts without adhesion [m].
// It follows from the leapfrog: the present velocity is the one that led here.
template <class Real>
TANDEM_HD Real overlap_before(const Contact<Real>& c) {
  const Real before = c.overlap + c.dt * c.normal_speed;
  const Real from = before > 0 ? before : Real(0);
  return from < c.overlap ? from : c.overlap;
}

// Powers of two in which springs are counted so that their squares stay within the range of single precision:
// lengths up to 10 m and angles up to 1e9 rad, and what is 20 orders smaller.
template <class Real>
inline constexpr Real finer_lengths = 0x1p57;
template <class Real>
inline constexpr Real finer_angles = 0x1p30;

// The spring turned with the contact, which a rotation of both partners as one body leaves as it is for them:
// with the plane, so that its normal part goes, and about the normal. Its squared length becomes part/whole
// of what it was. Where a millionth of it would remain, or some 1e-23 m, nothing does.
template <class Real>
TANDEM_HD Vec3<Real> turned(Vec3<Real> spring, const Contact<Real>& c, Real part = 1, Real whole = 1,
                            Real finer = finer_lengths<Real>) {
  constexpr Real nothing = 0x1p-60, little = 0x1p-40;
  Vec3<Real> s = finer * spring;
  const Real kept = part * norm2(s);
  s -= dot(s, c.n) * c.n;
  s += c.turn * cross(c.n, s);
  const Real in_plane = whole * norm2(s);
  const bool remains = in_plane > nothing && kept > little * in_plane;
  const Real factor = remains ? (1 / finer) * root(quotient(kept, in_plane)) : Real(0);
  return factor * s;
}

// A tangential spring and dashpot within Coulomb's limit [N]; sets the force on i. Where it slides, the force
// has Coulomb's size, and the spring keeps no more than carries that alone. It is never stretched to the
// limit for the dashpot's sake: at a contact's begin the limit is near zero and the dashpot beyond it, and
// the spring would give back what nobody had put in.
template <class Real>
TANDEM_HD void limit_friction(ContactForce<Real>& f, Vec3<Real> slip, Real limit, Vec3<Real>& spring) {
  constexpr Real finer = 0x1p20, nothing = 0x1p-90;  // forces below 3e-20 N are not limited
  f.tangential = -(f.k_t * spring + f.c_t * slip);
  const Real most = finer * limit, most2 = most * most > nothing ? most * most : nothing;
  const Real size2 = norm2(finer * f.tangential), carried2 = norm2(finer * (f.k_t * spring));
  if (size2 > most2) {
    f.tangential *= quotient(most, root(size2));
    if (carried2 > most2) spring *= quotient(most, root(carried2));
  }
}

}  // namespace tandem::dem
