// Hertz's normal force with a damping that makes the coefficient of restitution independent of the impact
// speed.
//   F_n = k_n delta^(3/2) - c_n delta^(1/4) u_n,   k_n = 4/3 E* sqrt(R*),   c_n = alpha sqrt(m* k_n)
// Tsuji, Tanaka and Ishida 1992, Powder Technology 71:239, eq. 3-4; alpha(e) in closed form from Antypov and
// Elliott 2011. The closed form counts the impact until delta = 0, where F_n is slightly attractive just
// before: we keep that part, because cutting it off would return more than e.
#pragma once

#include <cmath>
#include <numbers>

#include "common/scene/model.hpp"
#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/history.hpp"

namespace tandem::dem {

// alpha = -sqrt(5) ln e / sqrt(ln^2 e + pi^2) solves the damped Hertz impact exactly (Antypov and Elliott
// 2011, EPL 94:50004, eq. 17); our damping force is alpha sqrt(m* k_h) delta^(1/4) u_n with k_h = 4/3 E*
// sqrt(R*). e = 0 has no finite ln; its limit is sqrt(5).
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

// The constants of every law on Hertz's stiffness: k_t/k_n = 8 G*/(4/3 E*), c_t/c_n = sqrt(2/3 k_t/k_n).
inline PairConstants<double> hertz_constants(const scene::Pair& pair, const scene::Material& a,
                                             const scene::Material& b) {
  const double e_star = effective_young(a, b), g_star = effective_shear(a, b);
  return {{4.0 / 3.0 * e_star, tsuji_alpha(pair.restitution), 6 * g_star / e_star,
           std::sqrt(4 * g_star / e_star), pair.friction, 0},
          true};
}

// Without friction: nothing tangential is loaded, stored or computed.
struct HertzFrictionless {
  static constexpr bool tangential = false, extended = false;

  static PairConstants<double> constants(const scene::Pair& pair, const scene::Material& a,
                                         const scene::Material& b) {
    return hertz_constants(pair, a, b);
  }

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k, std::uint32_t,
                                          Vec3<Real>&) const {
    const Real half = root(c.overlap);
    return {k.k_n * c.overlap * half - k.c_n * root(half) * c.normal_speed, {}};
  }
};

// Mindlin's no-slip stiffness on an incremental spring, limited by Coulomb's law.
//   F_t = -k_t sqrt(delta) s - c_t delta^(1/4) u_t,   k_t = 8 G* sqrt(R*),   c_t = alpha sqrt(2/3 m* k_t)
// Mindlin and Deresiewicz 1953 as simplified by Tsuji et al. 1992. While the overlap grows, force gained
// earlier keeps its value (dF_t = k_t sqrt(delta) ds), so the spring shrinks by sqrt(delta_old/delta); while
// it shrinks the force falls with sqrt(delta) (Thornton, Cummins and Cleary 2011, Powder Technology 210:189,
// sec. 2.2), which is what a fixed spring does.
//
// Coulomb's limit is mu times the elastic part of F_n, as in Itasca's PFC: the dashpot stands for losses
// inside the spheres, not for pressure on the surface. Since c_n delta^(1/4) u_n dt integrates to nothing
// over an impact, a sliding one then takes mu (1 + e) m* u of tangential momentum, as the theory of rigid
// impact has it, for every e. With the dashpot in the limit, and its attractive end cut off, it would be 3.4
// % more at e = 0.5.
struct HertzMindlin {
  static constexpr bool tangential = true, extended = false;

  static PairConstants<double> constants(const scene::Pair& pair, const scene::Material& a,
                                         const scene::Material& b) {
    return hertz_constants(pair, a, b);
  }

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k, std::uint32_t,
                                          Vec3<Real>& spring) const {
    ContactForce<Real> f;
    const Real half = root(c.overlap), quarter = root(half);
    f.elastic_force = k.k_n * c.overlap * half;
    f.normal = f.elastic_force - k.c_n * quarter * c.normal_speed;
    f.previous_stiffness2 = f.previous_hertz_overlap = overlap_before(c);
    f.current_stiffness2 = f.hertz_overlap = c.overlap;
    spring = rotate_spring(spring, c, f.previous_stiffness2, f.current_stiffness2) + c.dt * c.slip;
    f.k_n = k.k_n * half;
    f.k_t = k.k_t * half;
    f.c_t = k.c_t * quarter;
    limit_friction(f, c.slip, k.friction * f.elastic_force, spring);
    return f;
  }
};

}  // namespace tandem::dem
