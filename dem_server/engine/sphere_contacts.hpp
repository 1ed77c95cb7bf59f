// Number and mean stress of the contacts of a sphere.
#pragma once

#include <cstdint>

namespace tandem::dem {

// Of one listed pair.
template <class Real>
struct PairNormalForce {
  Real normal = 0;   // [N]
  Real overlap = 0;  // [m]
  std::uint32_t touching = 0;
};

struct SphereContacts {
  double mean_stress = 0;   // [Pa]
  std::uint32_t count = 0;  // with spheres and walls
};

}  // namespace tandem::dem
