// Powers that contact laws need, computed with square roots and products only, so that both back ends give
// the same bits.
#pragma once

#include <cmath>

#include "common/host_device.hpp"

namespace tandem::dem {

// x^(2/3) for x >= 0, by Newton's method on y^3 = x from above. `above` is an estimate of the result that may
// be too large.
template <class Real>
TANDEM_HD Real power_two_thirds(Real x, Real above) {
  if (!(x > 0)) return 0;
  Real y = std::sqrt(above);
  while (y * y * y < x) y *= 2;
  for (;;) {  // the iterates decrease, by a third each while they are far too large
    const Real next = (Real(2) * y + x / (y * y)) / Real(3);
    if (!(next < y)) break;
    y = next;
  }
  return y * y;
}

}  // namespace tandem::dem
