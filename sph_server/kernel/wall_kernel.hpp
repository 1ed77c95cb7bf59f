// The kernel as the integrals over walls use it.
#pragma once

#include "common/host_device.hpp"

namespace tandem::sph {

// The kernel as the part of it beyond a wall needs it: polynomials in s = r/R.
//
// Beyond a wall the liquid would go on as particles of spacing a, and a sum over particles is the integral of
// W - a^2/24 laplace(W) (midpoint rule in each cell). Without this term the first layer at a wall moves by a
// twentieth of the spacing (docs/experiments/2026-11-sph-walls.md).
struct WallKernel {
  static constexpr int terms = 8;
  double R = 0;            // support [m]
  double tail[terms]{};    // coefficients of the integral of f(s) s from s to 1
  double shadow[terms]{};  // of the antiderivative of t(s)/s^2, where t(s) is the integral of f(s) s^2 from s
                           // to 1, without the term -1/(42 s); t(s) = 1/42 + sum of k shadow[k] s^(k + 1)

  // f(s) = (1 - s)^4 (1 + 4 s) + 60 k (1 - s)^2 (1 - 2 s) with k = a^2 / (24 R^2).
  static WallKernel of(double support, double spacing) {
    const double k = spacing * spacing / (24 * support * support);
    return {support,
            {1.0 / 14 + k, 0, -0.5 - 30 * k, 80 * k, 2.5 - 75 * k, -4 + 24 * k, 2.5, -4.0 / 7},
            {0, 0, -1.0 / 6 - 10 * k, 20 * k, 0.5 - 15 * k, -2.0 / 3 + 4 * k, 5.0 / 14, -1.0 / 14}};
  }
  TANDEM_HD static double sum(const double* coefficient, double s) {
    double value = 0;
    for (int n = terms - 1; n >= 0; --n) value = value * s + coefficient[n];
    return value;
  }
};

}  // namespace tandem::sph
