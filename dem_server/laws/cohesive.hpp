// Hertz and Mindlin with attraction.
#pragma once

#include "dem_server/laws/hertz.hpp"
#include "dem_server/laws/powers.hpp"

namespace tandem::dem {

// A constant attraction over the contact area pi a^2, the intersection of the two spheres, a^2 = 2 R* delta:
//   F_n = Hertz - 2 pi Omega R* delta,   Omega: cohesion energy density [J/m3]
// This is the simplified JKR ("SJKR") of several codes. Friction is limited by the repulsive part alone,
// which is Hertz's.
struct Sjkr : HertzStiffness {
  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k,
                                          std::uint32_t law, Vec3<Real>& spring) const {
    ContactForce<Real> f = HertzMindlin{}(c, k, law, spring);
    f.normal -= Real(6.283185307179586) * c.adhesion * c.r_eff * c.overlap;
    return f;
  }
};

// [Johnson1971], w: work of adhesion [J/m2], a: contact radius:
//   delta = a^2/R* - sqrt(2 pi w a / E*),   F = 4/3 E* a^3/R* - sqrt(8 pi w E* a^3)
// A contact begins at delta = 0. It then lasts down to the overlap -0.4725 delta_0; under a constant pull it
// breaks at -3/2 pi w R*. With a = sqrt(R* delta_0) t^2 and delta_0^(3/2) = 2 pi w sqrt(R*) / E* both
// equations lose their parameters:
//   t^4 - t = delta/delta_0,   F = 4 pi w R* (2/3 t^6 - t^3)
// The damping and Mindlin's spring use the contact radius a where Hertz has sqrt(R* delta). Friction is
// limited by mu (F + 3 pi w R*) [Thornton1991].
struct Jkr : HertzStiffness {
  static constexpr double tear_off = 0.47247039371;  // 3/4^(4/3): -delta/delta_0 where the contact breaks [-]

  // Above this overlap [delta_0] adhesion is below all rounding: 1e-12 of Hertz's force.
  static constexpr double far_beyond = 1e8;

  // delta_0 [m], from k_n = 4/3 E* sqrt(R*). contact/parameters.cpp ensures that it is at most R*/2.
  template <class Real>
  TANDEM_HD static Real length(Real work, Real r_eff, Real k_n) {
    return power_two_thirds(Real(8.377580409572781) * work * r_eff / k_n, Real(2) * r_eff);
  }

  // The larger root of t^4 - t = x, x >= -tear_off, by Newton's method from above.
  template <class Real>
  TANDEM_HD static Real radius_parameter(Real x) {
    Real t = x > 0 ? Real(1) + std::sqrt(std::sqrt(x)) : Real(1);
    for (;;) {  // the iterates decrease until rounding stops them
      const Real t3 = t * t * t, slope = 4 * t3 - 1;
      if (!(slope > 0)) break;
      const Real next = t - (t3 * t - t - x) / slope;
      if (!(next < t)) break;
      t = next;
    }
    return t;
  }

  // Does an existing contact last at this overlap?
  template <class Real>
  TANDEM_HD static bool holds(const Contact<Real>& c, const Coefficients<Real>& k) {
    return c.adhesion > 0 && c.overlap > -Real(tear_off) * length(c.adhesion, c.r_eff, k.k_n);
  }

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k,
                                          std::uint32_t law, Vec3<Real>& spring) const {
    if (!(c.adhesion > 0)) return HertzMindlin{}(c, k, law, spring);
    const Real unit = length(c.adhesion, c.r_eff, k.k_n), root_unit = std::sqrt(unit);
    if (c.overlap > Real(far_beyond) * unit) return HertzMindlin{}(c, k, law, spring);
    const auto radius_parameter_at = [&](Real overlap) {
      const Real x = overlap / unit;
      return radius_parameter(x > -Real(tear_off) ? x : -Real(tear_off));
    };
    ContactForce<Real> f;
    const Real t = radius_parameter_at(c.overlap), t3 = t * t * t;
    const Real pull = Real(12.566370614359172) * c.adhesion * c.r_eff;  // 4 pi w R* [N]
    const Real half = root_unit * t * t, quarter = std::sqrt(half);     // half: a / sqrt(R*) [m^(1/2)]
    const Real elastic = pull * (Real(2) / 3 * t3 * t3 - t3);
    f.normal = elastic - k.c_n * quarter * c.normal_speed;
    f.elastic_force = elastic + Real(0.75) * pull;
    const Real t_old = radius_parameter_at(c.overlap + c.dt * c.normal_speed), least = t_old < t ? t_old : t;
    f.previous_stiffness2 = least * least * least * least;
    f.current_stiffness2 = t * t3;
    f.hertz_overlap = unit * f.current_stiffness2;
    f.previous_hertz_overlap = unit * f.previous_stiffness2;
    add_mindlin(c, k, half, quarter, f, spring);
    return f;
  }
};

}  // namespace tandem::dem
