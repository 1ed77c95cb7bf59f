// The kernel of Wendland, of class C2, in three dimensions [Wendland1995]:
//   W(r) = 21/(16 pi h^3) (1 - q/2)^4 (1 + 2 q), q = r/h, for r < 2 h
// Lengths are divided by the support R = 2 h below: s = r/R, so that
//   W = 21/(2 pi R^3) (1 - s)^4 (1 + 4 s)  and  (1/r) dW/dr = -210/(pi R^5) (1 - s)^3.
#pragma once

#include <numbers>

#include "common/host_device.hpp"

namespace tandem::sph {

template <class Real>
struct Kernel {
  Real support = 0;  // R = 2 h [m]
  Real inverse = 0;  // 1/R [1/m]
  Real peak = 0;     // W(0) [1/m3]
  Real slope = 0;    // (1/r) dW/dr at r = 0, negative [1/m5]

  TANDEM_HD static Kernel of_support(double R) {
    constexpr double pi = std::numbers::pi;
    return {static_cast<Real>(R), static_cast<Real>(1 / R), static_cast<Real>(21 / (2 * pi * R * R * R)),
            static_cast<Real>(-210 / (pi * R * R * R * R * R))};
  }

  // W at distance r <= R [1/m3].
  TANDEM_HD Real value(Real r) const {
    const Real s = r * inverse, u = 1 - s;
    return at(s, u, u * u).value;
  }
  // The gradient of W at x_i is this times x_i - x_j; r <= R is their distance [1/m5].
  TANDEM_HD Real gradient_by_distance(Real r) const {
    const Real s = r * inverse, u = 1 - s;
    return at(s, u, u * u).gradient;
  }
  struct Both {
    Real value, gradient;
  };
  TANDEM_HD Both both(Real r) const {
    const Real s = r * inverse, u = 1 - s;
    return at(s, u, u * u);
  }

 private:
  TANDEM_HD Both at(Real s, Real u, Real u2) const {
    return {peak * (u2 * u2) * (1 + 4 * s), slope * (u2 * u)};
  }
};

}  // namespace tandem::sph
