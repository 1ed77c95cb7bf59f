// Sums over all particles in one step. They are integers, so that every number of threads gives the same
// bits.
#pragma once

#include <cstdint>

#include "particles/base/fixed_point.hpp"

namespace tandem::sph {

// Powers that change the energy of the liquid, each computed from its own forces, and that of loads which
// bodies exchange at their common edges.
enum class Power : std::uint8_t { gravity, viscosity, bulk_viscosity, diffusion, ghost, walls, edges };
inline constexpr int powers = 7;

struct Tally {
  std::int64_t power[powers]{};
  std::int64_t momentum_rate[3]{};  // of the pair forces: zero, if they are antisymmetric
  std::int64_t largest_speed2 = 0, largest_compression = 0,
               largest_acceleration2 = 0;  // as bits of a double, which order like integers
  std::uint32_t crowded_by_facets = 0;

  void add(Power which, double watts, dem::Quantum q) {
    power[static_cast<int>(which)] += dem::to_fixed(watts, q);
  }
};

}  // namespace tandem::sph
