#pragma once

#include <cstddef>
#include <vector>

#include "common/math/vec3.hpp"

namespace tandem::particles {

// Spheres that a packing moves, and those that it must not touch.
struct PackedSpheres {
  std::vector<Vec3d> position;  // of centres [m] (spheres x 3)
  std::vector<double> radius;   // [m] (spheres)
  std::size_t moving = 0;       // the first ones; the others stay where they are
};

}  // namespace tandem::particles
