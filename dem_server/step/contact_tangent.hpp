// How the force of one contact of a sphere with a wall answers to a small
// motion of the wall.
#pragma once

#include <cstdint>

#include "common/math/vec3.hpp"

namespace tandem::dem {

struct ContactTangent {
  Vec3d arm;                // from the origin of the wall's body to the contact, world axes [m]
  Vec3d normal;             // from the wall to the sphere, world axes [-]
  double k_n = 0, k_t = 0;  // stiffness along the normal and across it [N/m]
  double d_n = 0, d_t = 0;  // damping, likewise [N s/m]
  std::uint32_t slot = 0;   // of the wall's body
};

}  // namespace tandem::dem
