#include "sph_server/coupling/wall_speed.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::sph {

double largest_wall_speed(const particles::BodyPose& body, std::span<const Vec3d> corners, Vec3d frame) {
  if (corners.empty()) return 0;
  const Vec3d v = body.R.transpose_times(body.v - frame), w = body.R.transpose_times(body.w);
  if (w == Vec3d{}) return norm(v);
  double most = 0;
  for (const Vec3d& corner : corners) most = std::max(most, norm2(v + cross(w, corner)));
  return std::sqrt(most);
}

}  // namespace tandem::sph
