// The circles at the two ends of a cylinder on planes and lines. A circle touches a plane with its lowest
// point: over a plane with the unit normal N at o, a circle about C with the axis s and the radius R has the
// gap
//   N . (C - o) - R |N x s|.
// On a line with the direction e it touches where the line passes through the plane of the circle, at q:
// along the normal of both the line and the circle, n = m - s (m . e) / (s . e) with m = (C - q) / |C - q|,
// the gap is
// (|C - q| - R) / |n| to first order.
#pragma once

#include "mbd_server/contact/touch_point.hpp"

namespace tandem::mbd {

inline bool is_rim(const ContactFeature& f) {
  return f.kind == ContactFeature::Kind::rim_on_plane || f.kind == ContactFeature::Kind::rim_on_line;
}

// The smallest sine of the angle between axis and normal, and cosine between axis and line.
inline constexpr double least_rim_sine = 0.2, least_rim_cosine = 0.3;

// As touch(). Throws Error{numerics} where the circle is pressed flat on the plane.
Touch touch_rim(const Model& model, const ContactFeature& feature, const std::vector<LinkMotion>& links,
                Derivatives derivatives);
// As foot().
Vector3d foot_of_rim(const Model& model, const ContactFeature& feature, const std::vector<LinkMotion>& links);

}  // namespace tandem::mbd
