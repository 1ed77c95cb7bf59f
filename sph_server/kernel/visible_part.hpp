// What a point sees of a facet: the facet without the shadows of other facets. Floors behind a sheet, back
// faces of plates and the facets of a mesh that intersects another one must not act through what hides them.
#pragma once

#include "common/math/vec3.hpp"
#include "particles/base/uninitialised.hpp"

namespace tandem::sph {

// A convex polygon. Copies have its corners, not the room for more of them.
struct Polygon {
  static constexpr int most = 16;
  particles::UninitialisedArray<Vec3d, most> corner;  // [m]
  int count = 0;

  Polygon() = default;
  TANDEM_HD Polygon(const Polygon& b) { *this = b; }
  TANDEM_HD Polygon& operator=(const Polygon& b) {
    count = b.count;
    for (int k = 0; k < b.count; ++k) corner[k] = b.corner[k];
    return *this;
  }
  TANDEM_HD void add(Vec3d x) {
    if (count < most) corner[count++] = x;
  }
};

// Cuts `p` along a plane: where dot(y - origin, normal) >= 0 it is `inside`, where <= 0 `outside`.
TANDEM_HD inline void cut(const Polygon& p, Vec3d origin, Vec3d normal, Polygon& inside, Polygon& outside) {
  inside.count = outside.count = 0;
  Vec3d a = p.corner[0];
  double at_a = p.count > 0 ? dot(a - origin, normal) : 0;
  const double at_first = at_a;
  for (int k = 0; k < p.count; ++k) {
    const bool last = k + 1 == p.count;
    const Vec3d b = p.corner[last ? 0 : k + 1];
    const double at_b = last ? at_first : dot(b - origin, normal);
    if (at_a >= 0) inside.add(a);
    if (at_a <= 0) outside.add(a);
    const bool leaves = (at_a < 0) != (at_b < 0), enters = (at_a > 0) != (at_b > 0);
    if (leaves || enters) {
      const Vec3d on_plane = a + (at_a / (at_a - at_b)) * (b - a);
      if (leaves) inside.add(on_plane);
      if (enters) outside.add(on_plane);
    }
    a = b;
    at_a = at_b;
  }
  if (inside.count < 3) inside.count = 0;
  if (outside.count < 3) outside.count = 0;
}

// The part of `p` where dot(y - origin, normal) >= 0.
TANDEM_HD inline Polygon clipped(const Polygon& p, Vec3d origin, Vec3d normal) {
  Polygon inside, outside;
  cut(p, origin, normal, inside, outside);
  return inside;
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

// The parts of a polygon, counter-clockwise about `facing`, that do not overlap and are all that x sees of it
// within `radius`, one after the other: what needs them can wait until all threads of a GPU's warp have one.
// shadow(k): what hides it, for k from 0 to hiders - 1.
template <class ShadowAt>
class VisibleParts {
 public:
  TANDEM_HD VisibleParts(const Polygon& whole, Vec3d facing, Vec3d x, double radius, int hiders,
                         const ShadowAt& shadow)
      : facing_(facing), x_(x), radius_(radius), hiders_(hiders), shadow_(shadow) {
    pending_[0] = whole;
    next_[0] = 0;
    count_ = 1;
  }

  // False if there is none any more.
  TANDEM_HD bool find_next(Polygon& part) {
    while (count_ > 0) {
      --count_;
      part = pending_[count_];
      int k = next_[count_];
      while (k < hiders_ && !is_cut(part, k)) ++k;
      if (k == hiders_) return true;
    }
    return false;
  }
  // False where too many parts were pending: some are missing.
  TANDEM_HD bool complete() const { return complete_; }

 private:
  static constexpr int most = 20;

  // Does shadow k cut the part? What it leaves is pending then.
  TANDEM_HD bool is_cut(const Polygon& part, int k) {
    const Shadow hides = shadow_(k);
    if (!hides.meets(part)) return false;
    // Each of the four cuts below adds one corner at most.
    if (part.count > Polygon::most - 4) return halve(part, k);
    // What is left of the part after the four cuts is hidden. A shadow that hides nothing within the radius
    // cuts nothing.
    int outsides = 0;
    Polygon rest = part, inside, outside;
    for (int side = 0; side < 4 && rest.count > 0; ++side) {
      cut(rest, hides.origin[side], hides.inward[side], inside, outside);
      if (matters(outside)) {
        if (count_ + outsides == most) return give_up();
        pending_[count_ + outsides] = outside;
        next_[count_ + outsides++] = k + 1;
      }
      rest = inside;
    }
    if (!matters(rest)) return false;
    count_ += outsides;
    return true;
  }
  TANDEM_HD bool halve(const Polygon& part, int k) {
    if (count_ + 2 > most) return give_up();
    const int middle = part.count / 2;
    Polygon &first = pending_[count_], &second = pending_[count_ + 1];
    first.count = second.count = 0;
    for (int n = 0; n <= middle; ++n) first.add(part.corner[n]);
    for (int n = middle; n <= part.count; ++n) second.add(part.corner[n < part.count ? n : 0]);
    next_[count_] = next_[count_ + 1] = k;
    count_ += 2;
    return true;
  }
  TANDEM_HD bool give_up() {
    complete_ = false;
    count_ = 0;
    return true;
  }
  TANDEM_HD bool matters(const Polygon& p) const {
    // Parts of less area are of rounding size [m2].
    return p.count > 0 && twice_area(p) > 1e-14 * radius_ * radius_ && !is_beyond(p, x_, facing_, radius_);
  }

  Vec3d facing_, x_;
  double radius_;
  int hiders_;
  const ShadowAt& shadow_;
  Polygon pending_[most];
  particles::UninitialisedArray<int, most> next_;  // the first shadow that the part has not been cut by
  int count_ = 0;
  bool complete_ = true;
};

}  // namespace tandem::sph
