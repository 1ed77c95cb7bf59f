// Hertz's normal force with a damping that makes the coefficient of restitution independent of the impact speed.
//   F_n = 4/3 E* sqrt(R* delta) delta - alpha sqrt(m* k_h) delta^(1/4) u_n,   k_h = 4/3 E* sqrt(R*)
// Tsuji, Tanaka and Ishida 1992, Powder Technology 71:239, eq. 3-4; alpha(e) in closed form from Antypov and Elliott
// 2011. The closed form counts the impact until delta = 0, where F_n is slightly attractive just before: we keep that
// part, because cutting it off would return more than e.
#pragma once

#include "dem_server/contact/laws/law.hpp"

namespace tandem::dem {

template <class Real>
TANDEM_HD Real hertz_normal_force(const Contact<Real>& c, const PairConstants<Real>& pair) {
  const Real stiffness = Real(4) / Real(3) * pair.e_star * std::sqrt(c.r_eff);  // k_h [N/m^1.5]
  const Real root = std::sqrt(c.overlap);
  const Real damping = pair.damping * std::sqrt(c.m_eff * stiffness * root);
  return stiffness * c.overlap * root - damping * c.normal_speed;
}

// Without friction: nothing tangential is loaded, stored or computed.
struct HertzFrictionless {
  static constexpr bool tangential = false;

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const PairConstants<Real>& pair, std::uint32_t,
                                          Vec3<Real>&) const {
    return {hertz_normal_force(c, pair), {}};
  }
};

// Mindlin's no-slip stiffness on an incremental spring, limited by Coulomb's law.
//   F_t = -k_t s - alpha sqrt(2/3 m* k_t) u_t,   k_t = 8 G* sqrt(R* delta)
// Mindlin and Deresiewicz 1953 as simplified by Tsuji et al. 1992. While the overlap grows, force gained earlier keeps
// its value (dF_t = k_t ds), so the spring shrinks by sqrt(delta_old/delta); while it shrinks the force falls with k_t
// (Thornton, Cummins and Cleary 2011, Powder Technology 210:189, sec. 2.2), which is what a fixed spring does.
// delta_old follows from the leapfrog: the present velocity is the one that led here.
struct HertzMindlin {
  static constexpr bool tangential = true;

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const PairConstants<Real>& pair, std::uint32_t,
                                          Vec3<Real>& spring) const {
    ContactForce<Real> f;
    f.normal = hertz_normal_force(c, pair);
    const Real k_t = Real(8) * pair.g_star * std::sqrt(c.r_eff * c.overlap);
    const Real overlap_old = c.overlap + c.dt * c.normal_speed;
    spring = turned(spring, c.n);
    if (overlap_old < c.overlap) {
      const Real share = overlap_old > 0 ? overlap_old / c.overlap : Real(0);
      spring *= std::sqrt(share);
    }
    spring += c.dt * c.slip;
    const Real damping = pair.damping * std::sqrt(Real(2) / Real(3) * c.m_eff * k_t);
    f.tangential = -(k_t * spring + damping * c.slip);
    const Real limit = f.normal > 0 ? pair.friction * f.normal : Real(0);
    const Real size2 = norm2(f.tangential);
    if (size2 > limit * limit) {
      // Sliding: the force has Coulomb's size, and the spring is what carries it alone.
      f.tangential *= limit / std::sqrt(size2);
      spring = (Real(-1) / k_t) * f.tangential;
    }
    return f;
  }
};

}  // namespace tandem::dem
