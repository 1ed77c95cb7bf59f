// A fingerprint of the spheres: equal for equal bits of position, velocity and spin, in order of id.
#pragma once

#include <string>

#include "dem_server/state/particles.hpp"

namespace tandem::dem {
std::string state_hash(const Spheres& spheres);  // 16 hexadecimal digits
}
