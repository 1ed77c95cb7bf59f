// Limits within which the result of a weakly compressible liquid may be trusted, for warnings and the
// verdict.
#pragma once

#include <cmath>

namespace tandem::sph {

// Of |rho/rho0 - 1|: pressures at rest are off by about that share.
inline constexpr double largest_density_error = 0.03;
// Speed over the speed of sound at the start and of walls: up to it particles are kept by walls.
inline constexpr double largest_mach = 0.1;
// Speed over the speed of sound of a liquid that moves: the stagnation pressure compresses it by half the
// square, 0.02, and is itself off by a quarter of the square, 0.01.
inline constexpr double largest_flow_mach = 0.2;

// Shares of the mass of the liquid that may exceed these limits at one time. Single droplets carry no load.
// An impact compresses liquid beyond the limit for as long as sound needs to leave it.
inline constexpr double largest_fast_share = 0.01, largest_dense_share = 0.05;

// Factor by which the speed of sound should grow to bring a figure to its limit [-]: the density error falls
// with the square of it, with a tenth in reserve; the speed of the liquid stays as it is.
inline double sound_factor_for_density(double density_error) {
  return 1.1 * std::sqrt(density_error / largest_density_error);
}
inline double sound_factor_for_mach(double mach) {
  return mach / largest_flow_mach;
}

}  // namespace tandem::sph
