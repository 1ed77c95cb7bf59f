// What a contact with friction remembers from one micro step to the next, and how friction uses it.
#pragma once

#include <cstdint>

#include "dem_server/base/arithmetic.hpp"
#include "dem_server/laws/contact.hpp"

namespace tandem::dem {

// The tangential spring of a contact with a wall.
template <class Real>
struct alignas(16) History {
  Vec3<Real> spring;        // elastic tangential displacement of i relative to j [m]
  std::uint32_t stamp = 0;  // micro step of the last contact; an older one is no history
};

// Rotation of one contact, where the scene has rolling or twisting. It is as old as the spring beside it.
template <class Real>
struct alignas(4 * sizeof(Real)) RollingSpring {
  Vec3<Real> rolled;  // relative angle across n [rad]
  Real twisted = 0;   // about n [rad]
};

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
TANDEM_HD Vec3<Real> rotate_spring(Vec3<Real> spring, const Contact<Real>& c, Real previous_stiffness2 = 1,
                                   Real current_stiffness2 = 1, Real finer = finer_lengths<Real>) {
  constexpr Real nothing = 0x1p-60, little = 0x1p-40;
  Vec3<Real> s = finer * spring;
  const Real kept = previous_stiffness2 * norm2(s);
  s -= dot(s, c.n) * c.n;
  s += c.normal_rotation * cross(c.n, s);
  const Real in_plane = current_stiffness2 * norm2(s);
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
