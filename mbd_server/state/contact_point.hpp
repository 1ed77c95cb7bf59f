// A point of contact between two bodies, as the state keeps it from step to step, and the manifold that the
// points of one pair of shapes are.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

// Which features of two shapes touch, or may touch soon: a ball of one shape (a corner, an end, a centre) on
// a plane, line, point or shape of the other, or two lines that cross. A feature stays for a step; features
// are found anew from step to step, and a code tells which is which.
struct ContactFeature {
  enum class Kind {
    shape,         // the ball on the round shape or box b
    plane,         // the ball on a plane of b
    line,          // the ball on a line of b
    point,         // the ball on a ball of b
    lines,         // a line of a on a line of b
    rim_on_plane,  // the circle about `place_a` across `axis_a` on a plane of b
    rim_on_line,   // the same on a line of b
    watch  // the ball or the circle on a mesh b, where no other feature of this ball touches: what is nearest
           // changes
  } kind = Kind::shape;
  int a = -1, b = -1;  // shapes; -1: none
  // Of shapes a and b. Features of one face have one code: their places tell them apart.
  std::int64_t code = 0;
  bool by_place = false;
  bool on_mesh = false;  // of a ball on a mesh: the place of contact tells it apart, and a `watch` finds it
  int face = -1;         // of the mesh; -1: none: one at the place of contact
  // In the frames of the links: centre of the ball, or a point of the line [m]; direction of the line, or
  // normal of the plane out of b. Lines a and b are oriented so that a x b points from a to b.
  Vector3d place_a = Vector3d::Zero(), axis_a = Vector3d::Zero(), place_b = Vector3d::Zero(),
           axis_b = Vector3d::Zero();
  double radius_a = 0, radius_b = 0;  // [m]
};

// Two shapes, the one with the smaller index first.
struct ShapePair {
  int a = -1, b = -1;
  auto operator<=>(const ShapePair&) const = default;
};
inline ShapePair pair_of(const ContactFeature& f) {
  return {std::min(f.a, f.b), std::max(f.a, f.b)};
}

// Spring and damper along the surfaces.
struct FrictionSpring {
  double stiffness = 0;  // [N/m]; Hertz: over depth^1/2 [N/m^3/2]
  double damping = 0;    // [N s/m]; Hertz: over depth^1/4 [N s/m^5/4]
  // Its ends on links a and b, frames of the links [m].
  Vector3d on_a = Vector3d::Zero(), on_b = Vector3d::Zero();
  // Hertz, where the spring changes with the depth: its stretch at the begin of the step, frame of link a
  // [m].
  Vector3d last_stretch = Vector3d::Zero();
};

// Spring and damper against rolling.
struct RollingSpring {
  double radius = 0;     // R* [m]; 0: no rolling friction
  double stiffness = 0;  // [N m/rad]; Hertz: over depth^1/2
  double damping = 0;    // [N m s/rad]; Hertz: over depth^1/4
  // Unit vectors whose difference is its stretch: on links a and b, frames of the links.
  Vector3d on_a = Vector3d::Zero(), on_b = Vector3d::Zero();
  Vector3d last_bend = Vector3d::Zero();  // as FrictionSpring::last_stretch [rad]
};

struct ContactPoint {
  ContactFeature feature;    // that touches
  double mass = 0;           // that the point feels as the contact begins [kg]
  double mass_a = 0;         // that it would feel there if the other body were fixed: of a [kg]; 0: a is held
  double mass_b = 0;         // of b, likewise
  double pressing_mass = 0;  // the largest that a point of the bodies feels that press each other here [kg]
  double entry_rate = 0;     // at which the shapes approached each other then [m/s]
  double entry_time = 0;     // [s]
  double finest = 0;         // length to which Newton's method finds the gap [m]; 0: its own tolerance does
  double period = 0;         // duration of an impact at that rate [s]; 0: it does not limit the steps
  double last_depth = 0;     // Hertz: depth at the begin of the step [m]
  FrictionSpring friction;
  RollingSpring rolling;
};

// The points in contact of one pair of shapes.
using ContactManifold = std::span<const ContactPoint>;

// The one list of the fields of a point: calls f(name, field); `point` is a ContactPoint or a const one.
template <class AnyPoint, class F>
void for_each_point_field(AnyPoint& point, F&& f) {
  auto& x = point.feature;
  f("shape_a", x.a), f("shape_b", x.b), f("kind", x.kind), f("code", x.code);
  f("by_place", x.by_place), f("on_mesh", x.on_mesh), f("face", x.face);
  f("place_a", x.place_a), f("axis_a", x.axis_a), f("place_b", x.place_b), f("axis_b", x.axis_b);
  f("radius_a", x.radius_a), f("radius_b", x.radius_b);
  f("mass", point.mass), f("mass_a", point.mass_a), f("mass_b", point.mass_b);
  f("pressing_mass", point.pressing_mass);
  f("entry_rate", point.entry_rate), f("entry_time", point.entry_time);
  f("finest", point.finest), f("period", point.period), f("last_depth", point.last_depth);
  f("friction/stiffness", point.friction.stiffness), f("friction/damping", point.friction.damping);
  f("friction/on_a", point.friction.on_a), f("friction/on_b", point.friction.on_b);
  f("friction/last_stretch", point.friction.last_stretch);
  f("rolling/radius", point.rolling.radius), f("rolling/stiffness", point.rolling.stiffness);
  f("rolling/damping", point.rolling.damping);
  f("rolling/on_a", point.rolling.on_a), f("rolling/on_b", point.rolling.on_b);
  f("rolling/last_bend", point.rolling.last_bend);
}

}  // namespace tandem::mbd
