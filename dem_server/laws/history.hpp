// State of a contact with friction from one micro step to the next, and how friction uses it.
#pragma once

#include <cstdint>

#include "dem_server/laws/contact.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/arithmetic.hpp"

namespace tandem::dem {

// The tangential spring of a contact with a wall.
template <class Real>
struct alignas(16) History {
  Vec3<Real> spring;        // elastic tangential displacement of i relative to j [m]
  std::uint32_t stamp = 0;  // micro step of the last contact; an entry with an older stamp holds no contact
};

// Rolling and twisting springs of one contact, in scenes with rolling or twisting. It is valid when the
// tangential spring of the same contact is.
template <class Real>
struct alignas(4 * sizeof(Real)) RollingSpring {
  Vec3<Real> rolled;  // relative angle across n [rad]
  Real twisted = 0;   // twist about n [rad]
};

// Springs are multiplied by these powers of two, so that their squares stay within the range of single
// precision: for lengths up to 10 m and angles up to 1e9 rad, and 20 orders of magnitude below.
template <class Real>
inline constexpr Real finer_lengths = 0x1p57;
template <class Real>
inline constexpr Real finer_angles = 0x1p30;

// Rotates a spring with its contact, so that a rotation of both partners as one rigid body leaves the force
// unchanged for an observer on them. The spring follows the contact plane, which removes its normal part, and
// the rotation about the normal. Its squared length is scaled by previous_stiffness2 / current_stiffness2.
// Returns zero where less than a millionth of the squared length would remain, or a length below some 1e-23
// m.
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

// Tangential spring and dashpot within Coulomb's limit [N]; sets the force on i. While the contact slides,
// the force has the size of the limit, and the spring is shortened to carry at most that. The spring is never
// stretched to make up for a dashpot above the limit: at the begin of a contact the limit is near zero and
// the dashpot above it, and the spring would later release energy that was never stored.
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
