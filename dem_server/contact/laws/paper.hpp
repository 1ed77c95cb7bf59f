// The law of the paper that this project reproduces ("Cosimulation of MBD and DEM of many spheres", eq. 3-4):
//   F_n = k_n delta^1.5 n + c_n u_n delta^0.25
//   F_t = min[ k_t delta_t^1.5 t + c_t u_t delta_t^0.25,  mu |F_n| t ]
// delta_t is the length of the tangential displacement, t its direction. The paper is silent on how the
// displacement follows a turning contact plane and on what remains of it after sliding: here it turns with
// the plane, and sliding leaves the displacement whose spring force is Coulomb's limit.
#pragma once

#include "dem_server/contact/laws/law.hpp"

namespace tandem::dem {

// x^(2/3) for 0 < x^(2/3) <= above, by Newton's method on y^3 = x from above: square roots and products only,
// so that both back ends give the same bits.
template <class Real>
TANDEM_HD Real power_two_thirds(Real x, Real above) {
  Real y = std::sqrt(above);
  for (int iteration = 0; iteration < 40; ++iteration) {
    const Real next = (Real(2) * y + x / (y * y)) / Real(3);
    if (!(next < y)) break;
    y = next;
  }
  return y * y;
}

struct Paper {
  static constexpr bool tangential = true;

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k, std::uint32_t,
                                          Vec3<Real>& spring) const {
    ContactForce<Real> f;
    const Real root = std::sqrt(c.overlap);
    f.normal = k.k_n * c.overlap * root - k.c_n * std::sqrt(root) * c.normal_speed;

    spring = turned(spring, c.n) + c.dt * c.slip;
    const Real length2 = norm2(spring), length = std::sqrt(length2);
    if (!(length > 0)) return f;
    const Real length_root = std::sqrt(length);
    f.tangential = -(k.k_t * length_root * spring + k.c_t * std::sqrt(length_root) * c.slip);
    const Real limit = f.normal > 0 ? k.friction * f.normal : Real(0);
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
