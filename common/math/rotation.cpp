#include "common/math/rotation.hpp"

namespace tandem {

Quat exp(Vec3d phi) {
  const double angle2 = norm2(phi), angle = std::sqrt(angle2);
  // sin(a/2)/a by its series where the quotient would lose digits.
  const double s = angle < 1e-4 ? 0.5 - angle2 / 48 : std::sin(angle / 2) / angle;
  return Quat{std::cos(angle / 2), s * phi.x, s * phi.y, s * phi.z}.normalized();
}

Vec3d rotation_vector(Quat q) {
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const double s = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z);
  const double f = s < 1e-8 ? 2 / q.w : 2 * std::atan2(s, q.w) / s;
  return {f * q.x, f * q.y, f * q.z};
}

}  // namespace tandem
