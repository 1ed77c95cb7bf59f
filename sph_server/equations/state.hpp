// Equation of state of Tait for a weakly compressible liquid [Monaghan1994]:
//   p = rho0 c0^2 / 7 ((rho/rho0)^7 - 1)
// The state is the compression e = rho/rho0 - 1, which keeps its digits where it is small.
#pragma once

#include <cmath>

#include "common/host_device.hpp"

namespace tandem::sph {

// p in units of rho0 c0^2 [-]; the expanded power keeps the digits of a small e.
TANDEM_HD inline double tait_pressure(double e) {
  return e * (1 + e * (3 + e * (5 + e * (5 + e * (3 + e * (1 + e / 7))))));
}

// The compression at a pressure p >= 0 in units of rho0 c0^2 [-].
inline double compression_at(double p) {
  return std::expm1(std::log1p(7 * p) / 7);
}

// Energy of compression per mass in units of c0^2: the integral of p/rho^2 from rho0 to rho [-]:
//   ((1 + e)^6 / 6 + 1/(1 + e) - 7/6) / 7
TANDEM_HD inline double tait_energy(double e) {
  // (1 + e)^7 + 6 - 7 (1 + e) = e^2 (21 + 35 e + 35 e^2 + 21 e^3 + 7 e^4 + e^5)
  return e * e * (21 + e * (35 + e * (35 + e * (21 + e * (7 + e))))) / (42 * (1 + e));
}

}  // namespace tandem::sph
