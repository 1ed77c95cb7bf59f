// A hash of the bits of position, velocity and spin of the spheres, in order of id.
#pragma once

#include <string>

#include "dem_server/laws/particle_names.hpp"
#include "particles/state/particles.hpp"

namespace tandem::dem {
std::string state_hash(const Spheres& spheres);  // 16 hexadecimal digits
}
