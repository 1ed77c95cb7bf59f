// What a point sees of a facet: the facet without the shadows of other facets. Floors behind a sheet, back
// faces of plates and the facets of a mesh that intersects another one must not act through what hides them.
#pragma once

#include "common/math/vec3.hpp"
#include "particles/base/uninitialised.hpp"

namespace tandem::sph {

// A convex polygon.
struct Polygon {
  static constexpr int most = 16;
  particles::UninitialisedArray<Vec3d, most> corner;  // [m]
  int count = 0;
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

// Twice the area of a polygon in a plane [m2].
TANDEM_HD inline double twice_area(const Polygon& p) {
  Vec3d sum;
  for (int k = 2; k < p.count; ++k) sum += cross(p.corner[k - 1] - p.corner[0], p.corner[k] - p.corner[0]);
  return norm(sum);
}

// Calls each(polygon) for the n^2 triangles into which parallels to the edges through n - 1 points of each
// cut a triangle.
template <class Each>
TANDEM_HD void for_pieces(const Vec3d* corner, int n, Each each) {
  const Vec3d down = (1.0 / n) * (corner[1] - corner[0]), across = (1.0 / n) * (corner[2] - corner[1]);
  const auto at = [&](int row, int column) {
    return n == 1 ? corner[row + column]
                  : corner[0] + static_cast<double>(row) * down + static_cast<double>(column) * across;
  };
  Polygon piece;
  piece.count = 3;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column <= row; ++column) {
      piece.corner[0] = at(row, column);
      piece.corner[1] = at(row + 1, column);
      piece.corner[2] = at(row + 1, column + 1);
      each(piece);
      if (column == row) break;
      piece.corner[1] = at(row + 1, column + 1);
      piece.corner[2] = at(row, column + 1);
      each(piece);
    }
}

// Is every point of the polygon, counter-clockwise about `normal`, at least `radius` from x, seen across one
// edge? Cuts leave edges of rounding size, whose direction says nothing.
TANDEM_HD inline bool is_beyond(const Polygon& p, Vec3d x, Vec3d normal, double radius) {
  for (int k = 0; k < p.count; ++k) {
    const Vec3d edge = p.corner[k + 1 < p.count ? k + 1 : 0] - p.corner[k];
    if (norm2(edge) < 1e-12 * radius * radius) continue;
    const double away = dot(x - p.corner[k], cross(edge, normal));
    if (away > 0 && away * away >= radius * radius * norm2(edge)) return true;
  }
  return false;
}

// The space that a triangle hides from x: beyond its plane, and inside the three planes through x and an
// edge.
struct Shadow {
  Vec3d origin[4], inward[4];  // of the planes
  bool exists = false;         // false: x sees the triangle edge-on

  // What is less than `tolerance` [m] beyond the plane is not hidden.
  TANDEM_HD static Shadow of(Vec3d x, Vec3d a, Vec3d b, Vec3d c, Vec3d normal, double tolerance) {
    Shadow s;
    const double height = dot(x - a, normal);
    if (!(height > tolerance || height < -tolerance)) return s;
    s.exists = true;
    const Vec3d away = height > 0 ? -normal : normal;
    const Vec3d corner[3] = {a, height > 0 ? b : c, height > 0 ? c : b};
    s.origin[0] = a + tolerance * away;
    s.inward[0] = away;
    for (int k = 0; k < 3; ++k) {
      s.origin[k + 1] = x;
      // The corners are counter-clockwise as seen from x.
      s.inward[k + 1] = cross(corner[k < 2 ? k + 1 : 0] - x, corner[k] - x);
    }
    return s;
  }
  TANDEM_HD bool meets(const Polygon& p) const {
    if (!exists) return false;
    for (int side = 0; side < 4; ++side)
      if (!reaches_beyond(p, origin[side], inward[side], 0)) return false;
    return true;
  }
};

// Calls each(polygon) for parts of `whole`, counter-clockwise about `facing`, that do not overlap and are all
// that x sees of it within `radius`. shadow(k): what hides it, for k from 0 to hiders - 1. False where too
// many parts are pending: some are missing then.
template <class ShadowAt, class Each>
TANDEM_HD bool for_visible_parts(const Polygon& whole, Vec3d facing, Vec3d x, double radius, int hiders,
                                 ShadowAt shadow, Each each) {
  constexpr int most = 20;
  // Parts of less area are of rounding size [m2].
  const double least = 1e-14 * radius * radius;
  particles::UninitialisedArray<Polygon, most> pending;
  particles::UninitialisedArray<int, most> next;  // the first shadow that the part has not been cut by
  int count = 1;
  pending[0] = whole;
  next[0] = 0;
  while (count > 0) {
    --count;
    const Polygon part = pending[count];
    int k = next[count];
    bool cut = false;
    for (; k < hiders && !cut; ++k) {
      const Shadow hides = shadow(k);
      if (!hides.meets(part)) continue;
      // Each of the four cuts below adds one corner at most; what has more corners falls into two halves.
      if (part.count > Polygon::most - 4) {
        if (count + 2 > most) return false;
        const int middle = part.count / 2;
        Polygon &first = pending[count], &second = pending[count + 1];
        first.count = second.count = 0;
        for (int n = 0; n <= middle; ++n) first.corner[first.count++] = part.corner[n];
        for (int n = middle; n <= part.count; ++n)
          second.corner[second.count++] = part.corner[n < part.count ? n : 0];
        next[count] = next[count + 1] = k;
        count += 2;
        cut = true;
        break;
      }
      // What is left of the part after the four cuts is hidden. A shadow that hides nothing
      // within `radius` cuts nothing.
      int outsides = 0;
      Polygon rest = part;
      for (int side = 0; side < 4 && rest.count > 0; ++side) {
        const Polygon outside = clipped(rest, hides.origin[side], -hides.inward[side]);
        if (outside.count > 0 && !is_beyond(outside, x, facing, radius) && twice_area(outside) > least) {
          if (count + outsides == most) return false;
          pending[count + outsides] = outside;
          next[count + outsides++] = k + 1;
        }
        rest = clipped(rest, hides.origin[side], hides.inward[side]);
      }
      if (rest.count == 0 || twice_area(rest) <= least || is_beyond(rest, x, facing, radius)) continue;
      count += outsides;
      cut = true;
    }
    if (!cut) each(part);
  }
  return true;
}

}  // namespace tandem::sph
