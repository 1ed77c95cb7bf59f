// The law of [MbdDem] eq. 3-4:
//   F_n = k_n delta^1.5 n + c_n u_n delta^0.25
//   F_t = min[ k_t delta_t^1.5 t + c_t u_t delta_t^0.25,  mu |F_n| t ]
// delta_t is the length of the tangential displacement, t its direction. The paper does not say how the
// displacement follows a rotating contact plane, nor what remains of it after sliding. Here it rotates with
// the plane, and sliding leaves the displacement whose spring force is Coulomb's limit.
#pragma once

#include "common/scene/model.hpp"
#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/durations.hpp"
#include "dem_server/laws/history.hpp"
#include "dem_server/laws/powers.hpp"

namespace tandem::dem {

struct Paper {
  static constexpr bool sized = false;
  static constexpr bool tangential = true, extended = false, belts = false;
  static constexpr const char* critical_time_name = "contact";
  static constexpr StiffnessKey stiffness{"normal_stiffness", &scene::Pair::normal_stiffness, -0.4};

  static PairConstants<double> constants(const scene::Pair& pair, const scene::Material&,
                                         const scene::Material&) {
    return {{pair.normal_stiffness, pair.normal_damping, pair.tangential_stiffness, pair.tangential_damping,
             pair.friction, 0},
            sized};
  }
  static double critical_time(const scene::Pair& pair, const scene::Material& own, double radius) {
    return contact_time(pair, sphere_mass(radius, own) / 2, radius);
  }
  static double collision_time(const scene::Pair& pair, const scene::Material& own, const scene::Material&,
                               double radius, double speed) {
    return hertz_collision_time(sphere_mass(radius, own) / 2, pair.normal_stiffness, speed);
  }

  // The stability limit of central differences for one contact of the reduced mass m, linearised at the
  // overlap 0.05 r (with larger overlaps a scene is too soft for its loads): with
  //   omega^2 = 3/2 k sqrt(0.05 r) / m,   zeta = c / (2 sqrt(3/2 k m)),
  // the shorter of the normal one (k_n, c_n, m) and the tangential one (k_t, c_t, 2/7 m, because the sphere
  // also rotates). zeta does not depend on the overlap [s].
  static double contact_time(const scene::Pair& pair, double mass, double radius) {
    const auto limit = [&](double k, double c, double m) {
      if (k == 0) return std::numeric_limits<double>::infinity();
      return central_difference_limit(std::sqrt(1.5 * k * std::sqrt(0.05 * radius) / m),
                                      c / (2 * std::sqrt(1.5 * k * m)));
    };
    return std::fmin(limit(pair.normal_stiffness, pair.normal_damping, mass),
                     limit(pair.tangential_stiffness, pair.tangential_damping, 2.0 / 7.0 * mass));
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
