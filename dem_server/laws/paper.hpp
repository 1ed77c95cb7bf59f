// The law of [MbdDem] eq. 3-4:
//   F_n = k_n delta^1.5 n + c_n u_n delta^0.25
//   F_t = min[ k_t delta_t^1.5 t + c_t u_t delta_t^0.25,  mu |F_n| t ]
// delta_t is the length of the tangential displacement, t its direction. The paper does not say how the
// displacement follows a rotating contact plane, nor what remains of it after sliding. Here it rotates with
// the plane, and sliding leaves the displacement whose spring force is Coulomb's limit.
#pragma once

#include "common/scene/model.hpp"
#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/history.hpp"
#include "dem_server/laws/powers.hpp"

namespace tandem::dem {

struct Paper {
  static constexpr bool tangential = true, extended = false;

  static PairConstants<double> constants(const scene::Pair& pair, const scene::Material&,
                                         const scene::Material&) {
    return {{pair.normal_stiffness, pair.normal_damping, pair.tangential_stiffness, pair.tangential_damping,
             pair.friction, 0},
            false};
  }

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k, std::uint32_t,
                                          Vec3<Real>& spring) const {
    ContactForce<Real> f;
    const Real half = std::sqrt(c.overlap);
    f.normal = k.k_n * c.overlap * half - k.c_n * std::sqrt(half) * c.normal_speed;

    spring = rotate_spring(spring, c) + c.dt * c.slip;
    const Real length = norm(spring);
    f.elastic_force = f.normal > 0 ? f.normal : Real(0);
    f.k_n = k.k_n * half;
    f.k_t = k.k_t * std::sqrt(length);
    f.previous_stiffness2 = f.previous_hertz_overlap = previous_overlap(c);
    f.current_stiffness2 = f.hertz_overlap = c.overlap;
    if (!(length > 0)) return f;
    const Real length_root = std::sqrt(length);
    f.tangential = -(k.k_t * length_root * spring + k.c_t * std::sqrt(length_root) * c.slip);
    const Real limit = k.friction * f.elastic_force;
    const Real size2 = norm2(f.tangential);
    if (size2 > limit * limit) {
      f.tangential *= limit / std::sqrt(size2);
      if (k.k_t * length * length_root > limit)
        spring *= limit > 0 ? power_two_thirds(limit / k.k_t, length) / length : Real(0);
    }
    return f;
  }
};

}  // namespace tandem::dem
