// Where facets of two bodies meet. Behind one of them is ghost liquid, which would press on the ghost liquid
// behind the other one. Without that, each wall alone carries too little near the edge: as much as if it
// ended some 0.3 spacings before it.
#pragma once

#include <cmath>

#include "common/math/vec3.hpp"

namespace tandem::sph {

// Facets continue each other in one plane where the sine of the angle between them is below this.
inline constexpr double least_sine = 0.1;

struct Triangle {
  Vec3d corner[3];  // [m]
  Vec3d normal;     // unit, along (corner[1] - corner[0]) x (corner[2] - corner[0])
};

// Shrinks the part [begin, end] of the line origin + s direction (a unit vector) to what is in the triangle.
// Next to an edge that is parallel to it, the line may be outside by `tolerance`.
TANDEM_HD inline void limit_to(const Triangle& t, Vec3d origin, Vec3d direction, double tolerance,
                               double& begin, double& end) {
  constexpr double parallel = 0.05;
  for (int k = 0; k < 3; ++k) {
    const Vec3d edge = t.corner[k < 2 ? k + 1 : 0] - t.corner[k], inward = normalized(cross(t.normal, edge));
    const double at = dot(origin - t.corner[k], inward), slope = dot(direction, inward);
    if (std::fabs(slope) < parallel) {
      if (at < -tolerance) end = begin;
    } else if (slope > 0) {
      begin = std::fmax(begin, -at / slope);
    } else {
      end = std::fmin(end, -at / slope);
    }
  }
}

// Has the triangle a corner on that side of the plane of `other` where x is? One that ends at the plane has
// not: the floor behind a sheet is no wall of the liquid in front of it.
TANDEM_HD inline bool reaches_to_side_of(const Triangle& t, const Triangle& other, Vec3d x,
                                         double tolerance) {
  const double side = dot(x - other.corner[0], other.normal) < 0 ? -1 : 1;
  for (const Vec3d& corner : t.corner)
    if (side * dot(corner - other.corner[0], other.normal) > tolerance) return true;
  return false;
}

// Least height of the triangle [m].
TANDEM_HD inline double least_height(const Triangle& t) {
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::fmax(longest, norm(t.corner[k < 2 ? k + 1 : 0] - t.corner[k]));
  return norm(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0])) / longest;
}

// Up to which distance two facets join: of narrow ones only those beside the edge do.
TANDEM_HD inline double joint_gap(const Triangle& f, const Triangle& g, double tolerance) {
  return std::fmin(tolerance, 0.25 * std::fmin(least_height(f), least_height(g)));
}

// The strip of the plane of `f` that continues beyond `g`, seen from x, along the line where both facets are:
// four corners, counter-clockwise about the normal of `f`. False where they do not meet within
// joint_gap(), where one of them ends at the other on the far side from x, or where they are nearly
// parallel. width: of the strip [m].
TANDEM_HD inline bool strip_beyond(const Triangle& f, const Triangle& g, Vec3d x, double width,
                                   double tolerance, Vec3d* strip) {
  const Vec3d across = cross(f.normal, g.normal);
  const double sine = norm(across);
  if (sine < least_sine) return false;
  if (!reaches_to_side_of(f, g, x, 1e-3 * width) || !reaches_to_side_of(g, f, x, 1e-3 * width)) return false;
  const Vec3d along = (1 / sine) * across;
  // The point of both planes that is nearest to x.
  const double to_f = dot(f.corner[0] - x, f.normal), to_g = dot(g.corner[0] - x, g.normal),
               cosine = dot(f.normal, g.normal), inverse = 1 / (sine * sine);
  const Vec3d origin =
      x + ((to_f - cosine * to_g) * inverse) * f.normal + ((to_g - cosine * to_f) * inverse) * g.normal;
  double begin = -width, end = width;
  const double apart = joint_gap(f, g, tolerance);
  limit_to(g, origin, along, apart, begin, end);
  limit_to(f, origin, along, apart, begin, end);
  if (!(begin < end)) return false;
  Vec3d beyond = cross(along, f.normal);
  if (dot(beyond, g.normal) * to_g < 0) beyond = -beyond;
  const bool counter_clockwise = dot(cross(along, beyond), f.normal) > 0;
  strip[0] = origin + (counter_clockwise ? begin : end) * along;
  strip[1] = origin + (counter_clockwise ? end : begin) * along;
  strip[2] = strip[1] + width * beyond;
  strip[3] = strip[0] + width * beyond;
  return true;
}

// The same for facets that continue each other in one plane, along an edge that they have in common: the
// strip of the plane through that edge and across them, behind them as seen from x. outward: in their plane,
// from f to g. False where they do not join within joint_gap().
TANDEM_HD inline bool strip_between(const Triangle& f, const Triangle& g, Vec3d x, double width,
                                    double tolerance, Vec3d* strip, Vec3d& outward) {
  if (norm(cross(f.normal, g.normal)) >= least_sine) return false;
  const double apart = joint_gap(f, g, tolerance);
  const Vec3d behind = dot(x - f.corner[0], f.normal) < 0 ? f.normal : -f.normal;
  for (int k = 0; k < 3; ++k) {
    const Vec3d a = f.corner[k], edge = f.corner[k < 2 ? k + 1 : 0] - a;
    const double length = norm(edge);
    const Vec3d along = (1 / length) * edge, out = cross(along, f.normal);
    // The corners of g on the edge, and none inside of it.
    double begin = length, end = 0;
    int on_edge = 0;
    bool outside = true;
    for (const Vec3d& corner : g.corner) {
      const double off = dot(corner - a, out), above = dot(corner - a, f.normal);
      outside = outside && off > -apart;
      if (std::fabs(off) > apart || std::fabs(above) > apart) continue;
      begin = std::fmin(begin, dot(corner - a, along));
      end = std::fmax(end, dot(corner - a, along));
      ++on_edge;
    }
    if (on_edge != 2 || !outside) continue;
    const double nearest = dot(x - a, along);
    begin = std::fmax(begin, std::fmax(0.0, nearest - width));
    end = std::fmin(end, std::fmin(length, nearest + width));
    if (!(begin < end)) continue;
    outward = out;
    const bool counter_clockwise = dot(cross(along, behind), out) > 0;
    strip[0] = a + (counter_clockwise ? begin : end) * along;
    strip[1] = a + (counter_clockwise ? end : begin) * along;
    strip[2] = strip[1] + width * behind;
    strip[3] = strip[0] + width * behind;
    return true;
  }
  return false;
}

}  // namespace tandem::sph
