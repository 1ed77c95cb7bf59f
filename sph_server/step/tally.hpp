// Sums over all particles in one step. They are integers, so that every number of threads gives the same
// bits.
#pragma once

#include <cstdint>

#include "particles/base/fixed_point.hpp"
#include "sph_server/equations/limits.hpp"

namespace tandem::sph {

// Powers that change the energy of the liquid, each computed from its own forces, and that of loads which
// bodies exchange at their common edges.
enum class Power : std::uint8_t {
  gravity,
  viscosity,
  bulk_viscosity,
  diffusion,
  cavitation,
  ghost,
  repulsion,
  walls,
  edges
};
inline constexpr int powers = 9;

struct Tally {
  std::int64_t power[powers]{};
  std::int64_t momentum_rate[3]{};  // of the pair forces: zero, if they are antisymmetric
  // Particles beyond the limits of speed and density, and sums of the squares of their Mach numbers and of
  // their compressions.
  std::uint32_t fast = 0, dense = 0;
  std::int64_t fast_mach2 = 0, dense_compression2 = 0;
  double largest_speed2 = 0, largest_acceleration2 = 0, largest_compression = 0;
  double holds_for = 1e300;  // all particles stay within their skins for this time at least [s]
  std::uint32_t crowded_by_facets = 0;
  std::uint32_t burst = 0;  // see PairSums

  TANDEM_HD void add(Power which, double watts, particles::Quantum q) {
    power[static_cast<int>(which)] += particles::to_fixed(watts, q);
  }
  // A value that is not a number remains.
  TANDEM_HD void observe(double speed2, double acceleration2, double compression) {
    keep(largest_speed2, speed2);
    keep(largest_acceleration2, acceleration2);
    keep(largest_compression, compression);
  }
  TANDEM_HD void stays_for(double time) {
    if (!(time >= holds_for) && holds_for == holds_for) holds_for = time;
  }
  // Counts a particle with the square of its Mach number and its |rho/rho0 - 1| where they exceed the limits.
  TANDEM_HD void judge(double mach2, double compression, particles::Quantum of_squares) {
    if (mach2 > largest_flow_mach * largest_flow_mach) {
      ++fast;
      fast_mach2 += particles::to_fixed(mach2, of_squares);
    }
    if (compression > largest_density_error) {
      ++dense;
      dense_compression2 += particles::to_fixed(compression * compression, of_squares);
    }
  }
  TANDEM_HD void add(const Tally& b) {
    fast += b.fast;
    dense += b.dense;
    fast_mach2 += b.fast_mach2;
    dense_compression2 += b.dense_compression2;
    for (int p = 0; p < powers; ++p) power[p] += b.power[p];
    for (int a = 0; a < 3; ++a) momentum_rate[a] += b.momentum_rate[a];
    observe(b.largest_speed2, b.largest_acceleration2, b.largest_compression);
    stays_for(b.holds_for);
    crowded_by_facets += b.crowded_by_facets;
    burst |= b.burst;
  }

 private:
  TANDEM_HD static void keep(double& largest, double value) {
    if (!(value <= largest) && largest == largest) largest = value;
  }
};

}  // namespace tandem::sph
