// What a point sees of a facet: the facet without the shadows of other facets. Floors behind a sheet, back
// faces of plates and the facets of a mesh that intersects another one must not act through what hides them.
#pragma once

#include "common/math/vec3.hpp"
#include "particles/base/uninitialised.hpp"

namespace tandem::sph {

// A convex polygon.
struct Polygon {
  static constexpr int most = 16;
  dem::UninitialisedArray<Vec3d, most> corner;  // [m]
  int count = 0;
};

// Parts of a facet that do not overlap.
struct Fragments {
  static constexpr int most = 32;
  dem::UninitialisedArray<Polygon, most> part;
  int count = 0;
  bool overflow = false;  // true: parts are missing

  TANDEM_HD void add(const Polygon& p) {
    if (p.count < 3) return;
    if (count < most)
      part[count++] = p;
    else
      overflow = true;
  }
};

// The part of `p` where dot(y - origin, normal) >= 0, appended to nothing: a polygon of its own.
TANDEM_HD inline Polygon clipped(const Polygon& p, Vec3d origin, Vec3d normal) {
  Polygon kept;
  for (int k = 0; k < p.count; ++k) {
    const Vec3d a = p.corner[k], b = p.corner[k + 1 < p.count ? k + 1 : 0];
    const double at_a = dot(a - origin, normal), at_b = dot(b - origin, normal);
    if (at_a >= 0 && kept.count < Polygon::most) kept.corner[kept.count++] = a;
    if ((at_a < 0) != (at_b < 0) && kept.count < Polygon::most)
      kept.corner[kept.count++] = a + (at_a / (at_a - at_b)) * (b - a);
  }
  if (kept.count < 3) kept.count = 0;
  return kept;
}

// Is any corner further than `tolerance` beyond the plane through `origin`, on the side of `normal`?
TANDEM_HD inline bool reaches_beyond(const Polygon& p, Vec3d origin, Vec3d normal, double tolerance) {
  for (int k = 0; k < p.count; ++k)
    if (dot(p.corner[k] - origin, normal) > tolerance) return true;
  return false;
}

// Removes from `parts` what the triangle a, b, c with unit normal `normal` hides from x. Parts that are less
// than `tolerance` [m] behind its plane remain.
TANDEM_HD inline void remove_hidden(Fragments& parts, Vec3d x, Vec3d a, Vec3d b, Vec3d c, Vec3d normal,
                                    double tolerance) {
  const double height = dot(x - a, normal);
  if (!(height > tolerance || height < -tolerance)) return;  // the plane is seen edge-on
  const Vec3d away = height > 0 ? -normal : normal;
  // The shadow is behind the plane, and inside the three planes through x and an edge.
  const Vec3d corner[3] = {a, height > 0 ? b : c, height > 0 ? c : b};
  Vec3d origin[4], inward[4];
  origin[0] = a + tolerance * away;
  inward[0] = away;
  for (int k = 0; k < 3; ++k) {
    origin[k + 1] = x;
    inward[k + 1] = cross(corner[k] - x, corner[k < 2 ? k + 1 : 0] - x);
    // Counter-clockwise as seen from x, so that the third corner is on the negative side.
    if (dot(corner[k < 1 ? 2 : k - 1] - x, inward[k + 1]) < 0) inward[k + 1] = -inward[k + 1];
  }
  const int before = parts.count;
  Fragments left;
  for (int k = 0; k < before; ++k) {
    Polygon rest = parts.part[k];
    bool hidden = true;
    for (int side = 0; side < 4 && hidden; ++side)
      hidden = reaches_beyond(rest, origin[side], inward[side], 0);
    if (!hidden) {
      left.add(rest);
      continue;
    }
    for (int side = 0; side < 4 && rest.count > 0; ++side) {
      left.add(clipped(rest, origin[side], -inward[side]));
      rest = clipped(rest, origin[side], inward[side]);
    }
  }
  left.overflow = left.overflow || parts.overflow;
  parts = left;
}

}  // namespace tandem::sph
