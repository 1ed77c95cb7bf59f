// How fast walls move, for warnings of walls that are too fast for the speed of sound.
#pragma once

#include <span>

#include "common/math/vec3.hpp"
#include "particles/geometry/path.hpp"

namespace tandem::sph {

// Largest speed of a wall of a body relative to `frame` [m/s]. Speeds of points of a triangle are at most
// those of its corners. corners: of its triangles, in the frame of the body [m]; frame: a velocity [m/s].
double largest_wall_speed(const particles::BodyPose& body, std::span<const Vec3d> corners, Vec3d frame);

}  // namespace tandem::sph
