#include "mbd_server/time_stepping/free_spin.hpp"

#include <Eigen/LU>

namespace tandem::mbd {

Vector3d free_spin(const Matrix3d& inertia, const Vector3d& spin, double h) {
  constexpr int most_iterations = 20;
  constexpr double round_off = 1e-15;
  Vector3d middle = spin;
  for (int i = 0; i < most_iterations; ++i) {
    const Vector3d momentum = inertia * middle,
                   residual = 2 * inertia * (middle - spin) + h * middle.cross(momentum);
    const Matrix3d slope = 2 * inertia + h * (skew(middle) * inertia - skew(momentum));
    const Vector3d change = slope.partialPivLu().solve(residual);
    middle -= change;
    if (change.norm() <= round_off * middle.norm()) break;
  }
  return 2 * middle - spin;
}

}  // namespace tandem::mbd
