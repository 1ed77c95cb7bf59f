// Contact of one sphere with one facet. The code uses only + - * / sqrt and comparisons, so that every back
// end gets the same bits.
#pragma once

#include <cmath>

#include "particles/base/fetch.hpp"
#include "particles/geometry/facet.hpp"

namespace tandem::particles {

struct WallContact {
  std::uint32_t patch = 0;  // names the contact: the lowest of the patches that join at `point`
  // A patch merged into this contact, otherwise `patch`. A contact that is new under `patch` has crossed an
  // edge if the last step had it under `neighbour`.
  std::uint32_t neighbour = 0;
  std::uint32_t facet = 0;  // the facet in contact
  Vec3d normal;             // from the wall to the sphere's centre, unit, body frame [-]
  double gap = 0;           // distance - radius, negative [m]
  Vec3d point;              // of the wall, closest to the centre, body frame [m]
};

// Closest point of a triangle to p by Voronoi regions ([Ericson2005] sec. 5.1.5). Scalar triple products
// about p, which stay accurate on slivers, decide the edge regions. Within the face the normal is the
// triangle's own, so that rounding does not vary it while a sphere rolls over the face. Returns false when
// the distance is not below `radius`.
TANDEM_HD inline bool touch_triangle(const Facet& t, Vec3d p, double radius, WallContact& out) {
  const Vec3d ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a, n = t.normal;
  const double height = dot(n, ap);
  if (!(height < radius && -height < radius)) return false;

  const Vec3d bp = p - t.b, cp = p - t.c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  bool face = false;
  if (d1 <= 0 && d2 <= 0) {
    out.point = t.a;
  } else if (d3 >= 0 && d4 <= d3) {
    out.point = t.b;
  } else if (d6 >= 0 && d5 <= d6) {
    out.point = t.c;
  } else if (d1 >= 0 && d3 <= 0 && dot(n, cross(ap, bp)) <= 0) {
    out.point = t.a + (d1 / (d1 - d3)) * ab;
  } else if (d2 >= 0 && d6 <= 0 && dot(n, cross(cp, ap)) <= 0) {
    out.point = t.a + (d2 / (d2 - d6)) * ac;
  } else if (d4 >= d3 && d5 >= d6 && dot(n, cross(bp, cp)) <= 0) {
    const double along = d4 - d3, back = d5 - d6;
    out.point = t.b + (along / (along + back)) * (t.c - t.b);
  } else {
    face = true;
  }

  const double side = height < 0 ? -1.0 : 1.0;  // both sides of a triangle are walls
  using std::sqrt;
  if (!face) {
    const Vec3d away = p - out.point;
    const double distance2 = norm2(away);
    if (distance2 >= radius * radius) return false;
    const double distance = sqrt(distance2);
    if (distance > 0) {
      out.normal = (1.0 / distance) * away;
      out.gap = distance - radius;
      return out.gap < 0;
    }
  }
  // In the face, or with the centre on an edge, where no direction but the triangle's normal is defined.
  out.normal = side * n;
  out.gap = side * height - radius;
  if (face) out.point = p - height * n;
  return out.gap < 0;
}

// A centre behind the plane is pushed out along the normal like any other.
TANDEM_HD inline bool touch_plane(const Facet& plane, Vec3d p, double radius, WallContact& out) {
  const double distance = dot(plane.normal, p - plane.a);
  out.normal = plane.normal;
  out.gap = distance - radius;
  out.point = p - distance * plane.normal;
  return out.gap < 0;
}

// Contact with the wall point out.point, on an edge or rim.
TANDEM_HD inline bool touch_point(Vec3d p, double radius, WallContact& out) {
  using std::sqrt;
  const Vec3d away = p - out.point;
  const double distance = sqrt(norm2(away));
  if (!(distance > 0)) return false;
  out.normal = (1.0 / distance) * away;
  out.gap = distance - radius;
  return out.gap < 0;
}

// Cylindrical coordinates of a point about the axis of a round facet.
struct AboutAxis {
  double along;    // coordinate along the axis, from the facet's centre [m]
  double rho;      // distance from the axis [m]
  Vec3d outwards;  // from the axis to the point, unit; facet.c on the axis [-]

  TANDEM_HD AboutAxis(const Facet& facet, Vec3d p) {
    using std::sqrt;
    const Vec3d d = p - facet.a;
    along = dot(facet.normal, d);
    const Vec3d radial = d - along * facet.normal;
    rho = sqrt(norm2(radial));
    outwards = rho > 0 ? (1.0 / rho) * radial : facet.c;
  }
};

// Both sides of a round wall are walls.
TANDEM_HD inline void touch_round(Vec3d centre, double wall_radius, double distance, Vec3d outwards,
                                  double radius, WallContact& out) {
  const double height = distance - wall_radius, side = height < 0 ? -1.0 : 1.0;
  out.normal = side * outwards;
  out.gap = side * height - radius;
  out.point = centre + wall_radius * outwards;
}

TANDEM_HD inline bool touch_cylinder(const Facet& f, Vec3d p, double radius, WallContact& out) {
  const AboutAxis at(f, p);
  const double half = f.half_height(), height = at.rho - f.radius();
  if (!(height < radius && -height < radius)) return false;
  if (at.along > half || at.along < -half) {  // beyond an end: its rim is nearest
    out.point = f.a + (at.along < 0 ? -half : half) * f.normal + f.radius() * at.outwards;
    return touch_point(p, radius, out);
  }
  touch_round(f.a + at.along * f.normal, f.radius(), at.rho, at.outwards, radius, out);
  return out.gap < 0;
}

TANDEM_HD inline bool touch_disc(const Facet& f, Vec3d p, double radius, WallContact& out) {
  const AboutAxis at(f, p);
  const double side = at.along < 0 ? -1.0 : 1.0;
  if (!(side * at.along < radius)) return false;
  if (at.rho > f.radius()) {
    out.point = f.a + f.radius() * at.outwards;
    return touch_point(p, radius, out);
  }
  out.normal = side * f.normal;
  out.gap = side * at.along - radius;
  out.point = p - at.along * f.normal;
  return out.gap < 0;
}

TANDEM_HD inline bool touch_ball(const Facet& f, Vec3d p, double radius, WallContact& out) {
  using std::sqrt;
  const Vec3d d = p - f.a;
  const double distance = sqrt(norm2(d));
  touch_round(f.a, f.radius(), distance, distance > 0 ? (1.0 / distance) * d : f.normal, radius, out);
  return out.gap < 0;
}

TANDEM_HD inline bool touch_facet(const Facet* facets, std::uint32_t index, Vec3d p, double radius,
                                  WallContact& out) {
  const Facet facet = fetch(facets + index);
  out.patch = out.neighbour = facet.patch;
  out.facet = index;
  switch (facet.kind) {
    case FacetKind::triangle:
      return touch_triangle(facet, p, radius, out);
    case FacetKind::plane:
      return touch_plane(facet, p, radius, out);
    case FacetKind::cylinder:
      return touch_cylinder(facet, p, radius, out);
    case FacetKind::disc:
      return touch_disc(facet, p, radius, out);
    case FacetKind::ball:
      return touch_ball(facet, p, radius, out);
  }
  return false;
}

}  // namespace tandem::particles
