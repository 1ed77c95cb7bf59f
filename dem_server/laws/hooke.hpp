// Linear springs and dashpots.
//   F_n = k_n delta - c_n u_n,   c_n = alpha sqrt(m* k_n)
//   F_t = -k_t s - c_t u_t,      c_t = alpha sqrt(2/7 m* k_t),   at most mu k_n delta
// [Cundall1979]; with alpha = -2 ln e / sqrt(ln^2 e + pi^2) the rebound from an impact that lasts until delta
// = 0 has e times the impact speed. The effective mass of a sphere's surface
// under a tangential force is 2/7 of its mass; with k_t = 2/7 k_n both springs therefore oscillate at one
// frequency [Schaefer1996], and a sticking contact returns -e times the tangential velocity. The spring alone
// limits friction, as in laws/hertz.hpp.
#pragma once

#include <cmath>
#include <numbers>

#include "common/scene/model.hpp"
#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/durations.hpp"
#include "dem_server/laws/history.hpp"

namespace tandem::dem {

// The coefficients c_n and c_t hold the factors of the square roots above [-].
struct Hooke {
  static constexpr bool sized = false;
  static constexpr const char* critical_time_name = "contact";
  static constexpr StiffnessKey stiffness{"spring_stiffness", &scene::Pair::spring_stiffness, -0.5};

  // alpha for this restitution e [-]; its limit for e = 0 is 2.
  static double damping(double restitution) {
    if (restitution <= 0) return 2;
    const double l = std::log(restitution);
    return -2 * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
  }

  static PairConstants<double> constants(const scene::Pair& pair, const scene::Material&,
                                         const scene::Material&) {
    const double alpha = damping(pair.restitution);
    return {{pair.spring_stiffness, alpha, pair.spring_ratio * pair.spring_stiffness,
             alpha * std::sqrt(2.0 / 7.0), pair.friction, 0},
            sized};
  }
  // Central differences with omega^2 = k / m and zeta = alpha / 2.
  static double critical_time(const scene::Pair& pair, const scene::Material& own, double radius) {
    const double mass = sphere_mass(radius, own) / 2, zeta = damping(pair.restitution) / 2;
    const double normal = central_difference_limit(std::sqrt(pair.spring_stiffness / mass), zeta);
    // The tangential mass is 2/7 m; a spring of the same ratio gives the same time.
    return normal / std::sqrt(std::fmax(1.0, 3.5 * pair.spring_ratio));
  }
  // Half of a period, whatever the speed.
  static double collision_time(const scene::Pair& pair, const scene::Material& own, const scene::Material&,
                               double radius, double) {
    return std::numbers::pi * std::sqrt(sphere_mass(radius, own) / 2 / pair.spring_stiffness);
  }

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k, std::uint32_t,
                                          Vec3<Real>& spring) const {
    ContactForce<Real> f;
    f.elastic_force = k.k_n * c.overlap;
    f.normal = f.elastic_force - k.c_n * std::sqrt(c.m_eff * k.k_n) * c.normal_speed;
    spring = rotate_spring(spring, c) + c.dt * c.slip;
    f.k_n = k.k_n;
    f.k_t = k.k_t;
    f.c_t = k.c_t * std::sqrt(c.m_eff * k.k_t);
    f.hertz_overlap = c.overlap;
    f.previous_hertz_overlap = previous_overlap(c);
    limit_friction(f, c.slip, k.friction * f.elastic_force, spring);
    return f;
  }
};

}  // namespace tandem::dem
