// The spin of a body without torque after a step, by the implicit midpoint rule for Euler's equations in the
// axes of the body: it keeps the energy and the size of the angular momentum.
#pragma once

#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

// I (w1 - w0) + h w x I w = 0 at w = (w0 + w1) / 2.
Vector3d free_spin(const Matrix3d& inertia, const Vector3d& spin, double h);

}  // namespace tandem::mbd
