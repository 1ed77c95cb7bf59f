// Linear springs and dashpots.
//   F_n = k_n delta - c_n u_n,   c_n = alpha sqrt(m* k_n)
//   F_t = -k_t s - c_t u_t,      c_t = alpha sqrt(2/7 m* k_t),   at most mu k_n delta
// [Cundall1979]; with alpha = -2 ln e / sqrt(ln^2 e + pi^2) the rebound from an impact that lasts until delta
// = 0 has e times the impact speed (common/scene/time_step.hpp). The effective mass of a sphere's surface
// under a tangential force is 2/7 of its mass; with k_t = 2/7 k_n both springs therefore oscillate at one
// frequency [Schaefer1996], and a sticking contact returns -e times the tangential velocity. The spring alone
// limits friction, as in laws/hertz.hpp.
#pragma once

#include <cmath>

#include "common/scene/model.hpp"
#include "common/scene/time_step.hpp"
#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/history.hpp"

namespace tandem::dem {

// The coefficients c_n and c_t hold the factors of the square roots above [-].
struct Hooke {
  static PairConstants<double> constants(const scene::Pair& pair, const scene::Material&,
                                         const scene::Material&) {
    const double damping = scene::hooke_damping(pair.restitution);
    return {{pair.spring_stiffness, damping, pair.spring_ratio * pair.spring_stiffness,
             damping * std::sqrt(2.0 / 7.0), pair.friction, 0},
            false};
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
