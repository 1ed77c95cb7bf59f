// Particles that were squeezed out of the region that they fill.
#pragma once

#include <cstddef>
#include <vector>

#include "common/math/vec3.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {

// Gives each particle of `left` a new place among `sites`, the places where all particles began: near where
// it began, away from walls, and as far from other particles as such a place can be. Of equal ones the first.
// False where walls are everywhere near it; `places` are then undefined.
bool put_back(std::vector<Vec3d>& places, const std::vector<std::size_t>& left,
              const std::vector<Vec3d>& sites, const Walls& walls, double spacing);

}  // namespace tandem::sph
