// Limits within which the result of a weakly compressible liquid may be trusted, for warnings and the
// verdict.
#pragma once

namespace tandem::sph {

// Of |rho/rho0 - 1|: pressures at rest are off by about that share.
inline constexpr double largest_density_error = 0.03;
// Speed over the speed of sound: up to it particles are kept by walls, and the density varies by about 1 %.
inline constexpr double largest_mach = 0.1;

}  // namespace tandem::sph
