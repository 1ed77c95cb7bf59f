// Integrals of the kernel over a flat facet and over the space behind it, as seen from a point x. A liquid
// that ends at walls lacks the part of the kernel beyond them; these integrals are that part, in closed form
// for any convex polygon [Ferrand2013, Mayrhofer2015]. The space behind a facet is its shadow for a lamp at
// x, so that a sheet without thickness hides what is on its other side.
#pragma once

#include <cmath>
#include <numbers>

#include "common/math/rotation.hpp"
#include "particles/base/elementary.hpp"
#include "sph_server/kernel/wall_kernel.hpp"

namespace tandem::sph {

struct FacetIntegrals {
  double surface = 0;  // integral of W over the facet [1/m]
  Vec3d moment;        // integral of (y - x) W over the points y of the facet [-]
  double shadow = 0;   // integral of W over the shadow [-]
  // Sum over the sides of the shadow, planes through x and an edge, of their normal away from the shadow
  // times the integral of (y - x) W over them. The sides of facets that join cancel [-].
  Mat3d sides;
  Vec3d rim;  // sum over the same sides of the normal times the integral of W over them [1/m]

  TANDEM_HD FacetIntegrals& operator+=(const FacetIntegrals& b) {
    surface += b.surface;
    moment += b.moment;
    shadow += b.shadow;
    for (int a = 0; a < 3; ++a) sides.row[a] += b.sides.row[a];
    rim += b.rim;
    return *this;
  }
};

// Where x is nearer to the line of an edge than this, divided by R, the side has no direction.
inline constexpr double smallest_side = 1e-9;

// What one edge adds to the integrals over a polygon, in polar coordinates about the foot of x in its plane;
// lengths are divided by R. d: distance of x from the plane; e: distance of the foot from the edge, positive
// where it is inside; the edge extends from t1 to t2, measured from the point of its line that is nearest.
struct EdgeIntegrals {
  double surface = 0;  // [-]
  double along = 0;    // integral of tail_of_surface along the edge [-]
  double shadow = 0;   // [-]
  // Integrals over the side of the shadow: the part beyond the edge of the plane through x and the edge [-].
  double side = 0;         // of W
  double side_across = 0;  // of the part of (y - x) W away from the edge's line, and of that along the edge
  double side_along = 0;
};

// Angle of the vector (x1, y1) minus that of (x0, y0), both with x >= 0 [rad].
TANDEM_HD inline double difference_of_angles(double y1, double x1, double y0, double x0) {
  return particles::angle_of(y1 * x0 - y0 * x1, x1 * x0 + y1 * y0);
}

// Inverse hyperbolic sine of to / n minus that of from / n, with from <= to and the roots s of the sums of
// their squares and n2 = n^2.
TANDEM_HD inline double difference_of_inverse_sinh(double from, double to, double s_from, double s_to,
                                                   double n2) {
  if (from >= 0) return particles::logarithm((to + s_to) / (from + s_from));
  if (to <= 0) return particles::logarithm((s_from - from) / (s_to - to));
  return particles::logarithm((to + s_to) * ((s_from - from) / n2));
}

TANDEM_HD inline EdgeIntegrals edge_integrals(const WallKernel& kernel, double d, double e, double t1,
                                              double t2) {
  EdgeIntegrals sum;
  const double tail = WallKernel::sum(kernel.tail, d), shadow = WallKernel::sum(kernel.shadow, d);
  const double angle = particles::angle_of(e * (t2 - t1), e * e + t1 * t2);
  const double nearest2 = d * d + e * e, reach2 = 1 - nearest2;
  double from = 0, to = 0, angle_within = 0;
  const double reach = reach2 > 0 ? std::sqrt(reach2) : 0;
  if (reach2 > 0) {
    from = std::fmin(std::fmax(t1, -reach), reach);
    to = std::fmin(std::fmax(t2, -reach), reach);
    angle_within = from == t1 && to == t2 ? angle : particles::angle_of(e * (to - from), e * e + from * to);
  }
  sum.surface = tail * angle;
  // At and beyond the support, s = 1.
  const double beyond = angle - angle_within;
  sum.shadow = (d * (WallKernel::sum(kernel.shadow, 1) - 1.0 / 42 - shadow) + 1.0 / 42) * beyond;
  if (!(from < to)) return sum;

  // i[k]: integral of s^k along the edge; j[k]: integral of s^k over the angle, with j[k + 2] = d^2 j[k] +
  // e i[k]. Index 0 holds k = -1.
  const double s_from = std::sqrt(nearest2 + from * from), s_to = std::sqrt(nearest2 + to * to);
  double i[9], j[9];
  const double nearest = std::sqrt(nearest2);
  i[0] = nearest > 0 ? difference_of_inverse_sinh(from, to, s_from, s_to, nearest2) : 0;
  i[1] = to - from;
  double power_from = s_from, power_to = s_to;
  for (int k = 1; k <= 7; ++k) {
    i[k + 1] = (to * power_to - from * power_from + k * nearest2 * i[k - 1]) / (k + 1);
    power_from *= s_from;
    power_to *= s_to;
  }
  // d j[-1] is a difference of two angles, with the sign of e, as the angle above, also of an e of rounding
  // size.
  const double inwards = std::fabs(e),
               seen = difference_of_angles(d * to, inwards * s_to, d * from, inwards * s_from);
  // An edge through the foot itself subtends no angle, unless the foot is between its ends.
  const double d_j = d == 0 || (e == 0 && from * to >= 0) ? 0 : std::copysign(seen, e);
  j[1] = angle_within;
  j[2] = d * d_j + e * i[0];
  for (int k = 3; k <= 8; ++k) j[k] = d * d * j[k - 2] + e * i[k - 2];

  double within = -shadow * j[1];
  for (int k = 0; k < WallKernel::terms; ++k) {
    sum.surface -= kernel.tail[k] * j[k + 1];
    sum.along += kernel.tail[k] * i[k + 1];
    within += kernel.shadow[k] * j[k + 1];
  }
  sum.shadow += (j[1] - d_j) / 42 + d * within;

  // The plane of the side goes through x: its d is 0, and its e is `nearest`. With t(s) of WallKernel the
  // moments are the integrals along the edge of t(s) e/s^3 times e and times the position along the edge.
  if (!(nearest > smallest_side)) return sum;
  sum.side = kernel.tail[0] * particles::angle_of(nearest * (to - from), nearest2 + from * to);
  sum.side_across = (to / s_to - from / s_from) / 42;
  sum.side_along = (1 / s_from - 1 / s_to) / 42;
  power_from = s_from;
  power_to = s_to;
  for (int k = 1; k < WallKernel::terms; ++k) {
    sum.side += kernel.tail[k] * nearest * i[k - 1];
    sum.side_across += k * kernel.shadow[k] * nearest2 * i[k - 1];
    sum.side_along += kernel.shadow[k] * (power_to - power_from);
    power_from *= s_from;
    power_to *= s_to;
  }
  sum.side_along *= nearest;
  return sum;
}

// Integrals over a convex polygon of `count` corners, counter-clockwise about `normal` (unit). x may be on
// either side of its plane. height: of x above the plane; its sign is the side on which x is, also where it
// is of rounding size [m].
TANDEM_HD inline FacetIntegrals facet_integrals(Vec3d x, const Vec3d* corner, int count, Vec3d normal,
                                                double height, const WallKernel& kernel) {
  const double R = kernel.R;
  const double d = std::fabs(height) / R, facing = height < 0 ? -1 : 1;
  constexpr double scale = 21 / (2 * std::numbers::pi);
  FacetIntegrals sum;
  if (!(d < 1)) return sum;
  double surface = 0, shadow = 0;
  Vec3d in_plane{};
  for (int k = 0; k < count; ++k) {
    const Vec3d begin = corner[k] - x, edge = corner[k + 1 < count ? k + 1 : 0] - corner[k];
    const double length = norm(edge);
    if (!(length > 0)) continue;
    const Vec3d along = (1 / length) * edge, outward = cross(along, normal);
    const double t = dot(begin, along) / R;
    const EdgeIntegrals one = edge_integrals(kernel, d, dot(begin, outward) / R, t, t + length / R);
    surface += one.surface;
    shadow += one.shadow;
    in_plane -= one.along * outward;
    const Vec3d to_line = begin - dot(begin, along) * along;
    const double distance = norm(to_line);
    if (!(distance > smallest_side * R)) continue;
    // The part of cross(to_line, along) along `outward` is the height.
    const Vec3d across = (1 / distance) * to_line, away = facing * cross(across, along),
                side = one.side_across * across + one.side_along * along;
    for (int a = 0; a < 3; ++a) sum.sides.row[a] += (scale * away[a]) * side;
    sum.rim += (scale / R * one.side) * away;
  }
  sum.surface = scale / R * surface;
  sum.shadow = scale * shadow;
  sum.moment = scale * in_plane - (d * R * facing * sum.surface) * normal;
  return sum;
}
TANDEM_HD inline FacetIntegrals facet_integrals(Vec3d x, const Vec3d* corner, int count, Vec3d normal,
                                                const WallKernel& kernel) {
  return facet_integrals(x, corner, count, normal, dot(x - corner[0], normal), kernel);
}

}  // namespace tandem::sph
