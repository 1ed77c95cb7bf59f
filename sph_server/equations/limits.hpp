// Limits within which the result of a weakly compressible liquid may be trusted, for warnings and the
// verdict.
#pragma once

#include <cmath>

namespace tandem::sph {

// Of |rho/rho0 - 1|: pressures at rest are off by about that share.
inline constexpr double largest_density_error = 0.03;
// Speed over the speed of sound: up to it particles are kept by walls, and the density varies by about 1 %.
inline constexpr double largest_mach = 0.1;

// Factor by which the speed of sound should grow to bring a figure to its limit [-]: the density error falls
// with the square of it, with a tenth in reserve; the speed of the liquid stays as it is.
inline double sound_factor_for_density(double density_error) {
  return 1.1 * std::sqrt(density_error / largest_density_error);
}
inline double sound_factor_for_mach(double mach) {
  return mach / largest_mach;
}

}  // namespace tandem::sph
