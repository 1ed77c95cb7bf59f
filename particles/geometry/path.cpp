#include "particles/geometry/path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "common/error.hpp"

namespace tandem::particles {
namespace {

// Jl(phi)^-1 v, Jl^-1 = I - [phi]/2 + (1/t^2 - (1 + cos)/(2 t sin)) [phi]^2 ([Chirikjian2012] eq. 10.86).
Vec3d inverse_left_jacobian_times(Vec3d phi, Vec3d v) {
  const double t = norm(phi);
  // The quotient loses digits as t falls; its series is 1/12 + t^2/720 + t^4/30240 + ...
  const double t2 = t * t;
  const double c = t < 0.1 ? (1 + t2 / 60 * (1 + t2 / 42 * (1 + t2 / 40))) / 12
                           : 1 / t2 - (1 + std::cos(t)) / (2 * t * std::sin(t));
  const Vec3d first = cross(phi, v);
  return v - 0.5 * first + c * cross(phi, first);
}

Quat unit(Quat q, const std::string& where) {
  if (!(std::abs(q.norm2() - 1) <= 1e-6)) {
    throw Error(ErrorCode::numerics,
                "orientation is not a unit quaternion (norm " + std::to_string(q.norm2()) + ")", where,
                "the sender must keep quaternions normalised");
  }
  return q.normalized();
}

}  // namespace

PreparedPath prepare_path(const PathSegment& segment, double H, const char* body) {
  const std::string where = *body != '\0' ? "body '" + std::string(body) + "'" : "body path";
  if (!(H > 0) || !std::isfinite(H)) throw Error(ErrorCode::internal, "window length is not positive", where);
  if (!is_finite(segment.begin.p_WB) || !is_finite(segment.end.p_WB) ||
      !is_finite(segment.begin_twist.v_WB) || !is_finite(segment.end_twist.v_WB)) {
    throw Error(ErrorCode::numerics, "position or velocity is not finite", where,
                "use a smaller coupling.window");
  }
  PreparedPath path{segment, H, {}, {}, {}};
  path.segment.begin.q_WB = unit(segment.begin.q_WB, where);
  path.segment.end.q_WB = unit(segment.end.q_WB, where);
  const Quat& from = path.segment.begin.q_WB;
  const Quat& to = path.segment.end.q_WB;
  // The rounding of the product must not rotate a body at rest.
  path.rotation_vector = from == to ? Vec3d{} : rotation_vector(to * from.conjugate());
  path.rotation_rate_begin = H * segment.begin_twist.w_WB;
  path.rotation_rate_end = inverse_left_jacobian_times(path.rotation_vector, H * segment.end_twist.w_WB);

  // The cubic stays in the convex hull of its Bézier points.
  const Vec3d third = (1.0 / 3) * path.rotation_rate_begin,
              two_thirds = path.rotation_vector - (1.0 / 3) * path.rotation_rate_end;
  const double rotation = std::max({norm(third), norm(two_thirds), norm(path.rotation_vector)});
  if (!(rotation <= max_turn)) {
    char text[160], hint[120];
    std::snprintf(text, sizeof text, "the body turns by %.3g rad in a window of %g s; the limit is %g rad",
                  rotation, H, max_turn);
    std::snprintf(hint, sizeof hint, "set coupling.window to %.1g s or less", 0.8 * H * max_turn / rotation);
    throw Error(ErrorCode::numerics, text, where, rotation > 0 ? hint : "the angular velocity is not finite");
  }
  return path;
}

}  // namespace tandem::particles
