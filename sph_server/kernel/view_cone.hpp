// Cones under which a point x sees triangles: what is outside of the cone of a triangle neither hides it nor
// is hidden by it.
#pragma once

#include <cmath>

#include "common/math/vec3.hpp"

namespace tandem::sph {

// A circular cone about all directions from x to the points of a triangle.
struct ViewCone {
  Vec3d axis;                    // unit, from x
  double cosine = -1, sine = 0;  // of the angle between axis and side; a cosine of -1: all directions

  TANDEM_HD static ViewCone of(Vec3d x, Vec3d a, Vec3d b, Vec3d c) {
    const Vec3d to[3] = {a - x, b - x, c - x};
    Vec3d unit[3], sum;
    for (int k = 0; k < 3; ++k) {
      const double distance = norm(to[k]);
      if (!(distance > 0)) return {};
      unit[k] = (1 / distance) * to[k];
      sum += unit[k];
    }
    const double length = norm(sum);
    if (!(length > 0)) return {};
    ViewCone cone;
    cone.axis = (1 / length) * sum;
    cone.cosine =
        std::fmin(dot(cone.axis, unit[0]), std::fmin(dot(cone.axis, unit[1]), dot(cone.axis, unit[2])));
    // The cap of a wide cone need not contain the triangle between its corners.
    if (!(cone.cosine > 0)) return {};
    cone.sine = std::sqrt(std::fmax(0.0, 1 - cone.cosine * cone.cosine));
    return cone;
  }
  // Have the cones no direction in common?
  TANDEM_HD bool is_apart_from(const ViewCone& other) const {
    constexpr double rounding = 1e-9;
    return cosine > 0 && other.cosine > 0 &&
           dot(axis, other.axis) < cosine * other.cosine - sine * other.sine - rounding;
  }
};

// The cone from x over a triangle, as three planes through x and an edge.
struct TriangleCone {
  Vec3d inward[3];  // unit normals; zero for an edge that x sees as a point

  // height: of x above the plane of the triangle, along (b - a) x (c - a).
  TANDEM_HD static TriangleCone of(Vec3d x, Vec3d a, Vec3d b, Vec3d c, double height) {
    // The corners are counter-clockwise as seen from x.
    const Vec3d corner[3] = {a - x, (height > 0 ? b : c) - x, (height > 0 ? c : b) - x};
    TriangleCone cone;
    for (int k = 0; k < 3; ++k) {
      const Vec3d inward = cross(corner[k < 2 ? k + 1 : 0], corner[k]);
      const double length = norm(inward);
      if (length > 0) cone.inward[k] = (1 / length) * inward;
    }
    return cone;
  }
  // Are all three points beyond one of the planes, or at most `tolerance` [m] inside of it?
  TANDEM_HD bool is_apart_from(Vec3d x, const Vec3d* corner, double tolerance) const {
    const Vec3d to[3] = {corner[0] - x, corner[1] - x, corner[2] - x};
    for (const Vec3d& n : inward) {
      if (norm2(n) == 0) continue;
      if (dot(to[0], n) <= tolerance && dot(to[1], n) <= tolerance && dot(to[2], n) <= tolerance) return true;
    }
    return false;
  }
};

}  // namespace tandem::sph
