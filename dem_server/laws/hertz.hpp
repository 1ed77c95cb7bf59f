// Hertz's normal force with a damping that makes the coefficient of restitution independent of the impact
// speed.
//   F_n = k_n delta^(3/2) - c_n delta^(1/4) u_n,   k_n = 4/3 E* sqrt(R*),   c_n = alpha sqrt(m* k_n)
// [Tsuji1992] eq. 3-4; alpha(e) in closed form from [Antypov2011]. The closed form assumes that an impact
// lasts until delta = 0. Just before that F_n is slightly attractive. The law keeps this part, because
// without it the rebound would be faster than e says.
#pragma once

#include <cmath>
#include <numbers>

#include "common/scene/model.hpp"
#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/durations.hpp"
#include "dem_server/laws/history.hpp"

namespace tandem::dem {

// alpha = -sqrt(5) ln e / sqrt(ln^2 e + pi^2) solves the damped Hertz impact exactly ([Antypov2011] eq. 17),
// for the damping force alpha sqrt(m* k_h) delta^(1/4) u_n with k_h = 4/3 E* sqrt(R*). ln e diverges at e =
// 0; the limit of alpha is sqrt(5).
inline double tsuji_alpha(double e) {
  if (e <= 0) return std::sqrt(5.0);
  const double l = std::log(e);
  return -std::sqrt(5.0) * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
}

// 1 / ((1 - nu_a^2) / E_a + (1 - nu_b^2) / E_b) [Pa]
inline double effective_young(const scene::Material& a, const scene::Material& b) {
  return 1 / ((1 - a.poisson * a.poisson) / a.young + (1 - b.poisson * b.poisson) / b.young);
}
// 1 / ((2 - nu_a) / G_a + (2 - nu_b) / G_b) [Pa]
inline double effective_shear(const scene::Material& a, const scene::Material& b) {
  const double shear_a = a.young / (2 * (1 + a.poisson)), shear_b = b.young / (2 * (1 + b.poisson));
  return 1 / ((2 - a.poisson) / shear_a + (2 - b.poisson) / shear_b);
}

// The constants of every law with Hertz's stiffness: k_t/k_n = 8 G*/(4/3 E*), c_t/c_n = sqrt(2/3 k_t/k_n).
inline PairConstants<double> hertz_constants(const scene::Pair& pair, const scene::Material& a,
                                             const scene::Material& b) {
  const double e_star = effective_young(a, b), g_star = effective_shear(a, b);
  return {{4.0 / 3.0 * e_star, tsuji_alpha(pair.restitution), 6 * g_star / e_star,
           std::sqrt(4 * g_star / e_star), pair.friction, 0},
          true};
}

// The time in which a surface wave crosses half of a sphere [s]:
//   T_R = pi r sqrt(rho / G) / (0.1631 nu + 0.8766),   G = E / (2 (1 + nu))
inline double rayleigh_time(double radius, const scene::Material& material) {
  const double shear = material.young / (2 * (1 + material.poisson));
  return std::numbers::pi * radius * std::sqrt(material.density / shear) /
         (0.1631 * material.poisson + 0.8766);
}

// What all laws with Hertz's stiffness have in common.
struct HertzStiffness {
  static constexpr bool sized = true;
  static constexpr const char* critical_time_name = "Rayleigh";
  static constexpr StiffnessKey stiffness{"young", nullptr, -0.4};

  static PairConstants<double> constants(const scene::Pair& pair, const scene::Material& a,
                                         const scene::Material& b) {
    return hertz_constants(pair, a, b);
  }
  static double critical_time(const scene::Pair&, const scene::Material& own, double radius) {
    return rayleigh_time(radius, own);
  }
  static double collision_time(const scene::Pair&, const scene::Material& own, const scene::Material& other,
                               double radius, double speed) {
    const double k = 4.0 / 3.0 * effective_young(own, other) * std::sqrt(radius / 2);
    return hertz_collision_time(sphere_mass(radius, own) / 2, k, speed);
  }
};

// Without friction: nothing tangential is loaded, stored or computed.
struct HertzFrictionless : HertzStiffness {
  static constexpr bool tangential = false, extended = false, belts = false;

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k, std::uint32_t,
                                          Vec3<Real>&) const {
    const Real half = root(c.overlap), elastic = k.k_n * c.overlap * half;
    return {elastic - k.c_n * root(half) * c.normal_speed, {}, elastic};
  }
};

// Adds the tangential part of Mindlin's law to a force whose normal part and stiffnesses are set. `half` is a
// / sqrt(R*) of the contact radius a, sqrt(delta) in Hertz's contact [m^(1/2)]; `quarter` is its root.
template <class Real>
TANDEM_HD void add_mindlin(const Contact<Real>& c, const Coefficients<Real>& k, Real half, Real quarter,
                           ContactForce<Real>& f, Vec3<Real>& spring) {
  spring = rotate_spring(spring, c, f.previous_stiffness2, f.current_stiffness2) + c.dt * c.slip;
  f.k_n = k.k_n * half;
  f.k_t = k.k_t * half;
  f.c_t = k.c_t * quarter;
  limit_friction(f, c.slip, k.friction * f.elastic_force, spring);
}

// Mindlin's no-slip stiffness with an incremental spring, limited by Coulomb's law.
//   F_t = -k_t sqrt(delta) s - c_t delta^(1/4) u_t,   k_t = 8 G* sqrt(R*),   c_t = alpha sqrt(2/3 m* k_t)
// [Mindlin1953] as simplified by [Tsuji1992]. While the overlap grows, the force gained earlier keeps its
// value (dF_t = k_t sqrt(delta) ds), so the spring shrinks by sqrt(delta_old/delta). While the overlap
// shrinks, the force falls with sqrt(delta) ([Thornton2011] sec. 2.2), as it does with an unchanged spring.
//
// Coulomb's limit is mu times the elastic part of F_n, as in Itasca's PFC: the dashpot models losses inside
// the spheres, not pressure on the surface. The integral of c_n delta^(1/4) u_n dt over an impact is zero. A
// sliding impact therefore takes mu (1 + e) m* u of tangential momentum, for every e, as in the theory of
// rigid impact. A limit that included the dashpot, with its attractive end cut off, would give 3.4 % more at
// e = 0.5.
struct HertzMindlin : HertzStiffness {
  static constexpr bool tangential = true, extended = false, belts = false;

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k, std::uint32_t,
                                          Vec3<Real>& spring) const {
    ContactForce<Real> f;
    const Real half = root(c.overlap), quarter = root(half);
    f.elastic_force = k.k_n * c.overlap * half;
    f.normal = f.elastic_force - k.c_n * quarter * c.normal_speed;
    f.previous_stiffness2 = f.previous_hertz_overlap = previous_overlap(c);
    f.current_stiffness2 = f.hertz_overlap = c.overlap;
    add_mindlin(c, k, half, quarter, f, spring);
    return f;
  }
};

// The same law in scenes with belts.
struct HertzMindlinWithBelts : HertzMindlin {
  static constexpr bool belts = true;
};

}  // namespace tandem::dem
