// Powers that laws need, of square roots and products only, so that both back ends give the same bits.
#pragma once

#include <cmath>

#include "common/host_device.hpp"

namespace tandem::dem {

// x^(2/3) for x >= 0, by Newton's method on y^3 = x from above; `above` is where it is expected to be, or
// more.
template <class Real>
TANDEM_HD Real power_two_thirds(Real x, Real above) {
  if (!(x > 0)) return 0;
  Real y = std::sqrt(above);
  while (y * y * y < x) y *= 2;
  for (;;) {  // each y is smaller than the one before, and by a third where it is far too large
    const Real next = (Real(2) * y + x / (y * y)) / Real(3);
    if (!(next < y)) break;
    y = next;
  }
  return y * y;
}

}  // namespace tandem::dem
