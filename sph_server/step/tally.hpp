// Sums over all particles in one step. They are integers, so that every number of threads gives the same
// bits.
#pragma once

#include <cstdint>

#include "particles/base/fixed_point.hpp"

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
  double largest_speed2 = 0, largest_acceleration2 = 0, largest_compression = 0;
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
  TANDEM_HD void add(const Tally& b) {
    for (int p = 0; p < powers; ++p) power[p] += b.power[p];
    for (int a = 0; a < 3; ++a) momentum_rate[a] += b.momentum_rate[a];
    observe(b.largest_speed2, b.largest_acceleration2, b.largest_compression);
    crowded_by_facets += b.crowded_by_facets;
    burst |= b.burst;
  }

 private:
  TANDEM_HD static void keep(double& largest, double value) {
    if (!(value <= largest) && largest == largest) largest = value;
  }
};

}  // namespace tandem::sph
