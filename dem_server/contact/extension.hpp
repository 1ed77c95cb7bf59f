// What the generic variant adds to a contact: sizes of the partners, adhesion, and moments against relative
// rotation. Other variants contain none of it.
#pragma once

#include "dem_server/contact/view.hpp"
#include "dem_server/laws/rolling.hpp"

namespace tandem::dem {

template <class Real>
struct Extension {
  PairExtras<Real> pair;
  Real inertia = 0;  // I* of laws/rolling.hpp [kg m2]
};

namespace detail {

// Inertia of a sphere about a point of its surface [kg m2].
template <class Real>
TANDEM_HD Real rolling_inertia(Real mass, Real radius) {
  return Real(1.4) * mass * radius * radius;
}

}  // namespace detail

// Sets the sizes of the contact of two spheres with these masses [kg] and radii [m].
template <class Real>
TANDEM_HD void set_sizes(Contact<Real>& c, Real mass, Real radius, Real other_mass, Real other_radius) {
  c.r_eff = in_series(radius, other_radius);
  c.m_eff = in_series(mass, other_mass);
}

// I* of two spheres, laws/rolling.hpp [kg m2].
template <class Real>
TANDEM_HD Real rolling_inertia(Real mass, Real radius, Real other_mass, Real other_radius) {
  return in_series(detail::rolling_inertia(mass, radius), detail::rolling_inertia(other_mass, other_radius));
}

// Completes the contact of two spheres of materials m and n.
template <class Real>
TANDEM_HD Extension<Real> extend(const View<Real>& view, Contact<Real>& c, std::uint32_t m, Real radius,
                                 std::uint32_t n, Real other_radius) {
  const Real mass = sphere_mass(view.parameters.mass_per_volume[m], radius),
             other_mass = sphere_mass(view.parameters.mass_per_volume[n], other_radius);
  set_sizes(c, mass, radius, other_mass, other_radius);
  const PairExtras<Real> pair = view.extras[m * max_materials + n];
  c.adhesion = pair.adhesion;
  if (!view.parameters.rolling) return {pair, 0};
  return {pair, rolling_inertia(mass, radius, other_mass, other_radius)};
}

// Completes the contact of a sphere with a wall. The contact does not change the wall's motion, so m* = m.
template <class Real>
TANDEM_HD Extension<Real> extend_at_wall(const View<Real>& view, Contact<Real>& c, std::uint32_t m,
                                         Real radius, std::uint32_t wall_material, Real r_eff) {
  c.r_eff = r_eff;
  c.m_eff = sphere_mass(view.parameters.mass_per_volume[m], radius);
  const PairExtras<Real> pair = view.extras[m * max_materials + wall_material];
  c.adhesion = pair.adhesion;
  return {pair, detail::rolling_inertia(c.m_eff, radius)};
}

// Moment of rolling and twisting on i [N m]. `rate` is the angular velocity of i relative to j [rad/s].
// `rolling` holds the springs of the contact; they are valid if it `existed` in the last step, otherwise they
// start from zero.
template <class Real>
TANDEM_HD Vec3<Real> rolling_moment(const View<Real>& view, const Contact<Real>& c,
                                    const ContactForce<Real>& f, const Extension<Real>& e, Real friction,
                                    Vec3<Real> rate, RollingSpring<Real>* rolling, bool existed) {
  Vec3<Real> moment;
  if (rolling == nullptr) return moment;
  RollingSpring<Real> t;
  if (existed) t = *rolling;
  if (view.parameters.rolling) moment += RollingResistance{}(c, f, rate, e.pair.rolling, e.inertia, t.rolled);
  if (view.parameters.twisting) moment += TwistingResistance{}(c, f, rate, friction, t.twisted) * c.n;
  *rolling = t;
  return moment;
}

}  // namespace tandem::dem
