// The plane of the road under a tyre.
//
// The road is met at four points around the point of contact, half of the patch's length ahead, behind and to
// both sides, by rays against the direction upwards. With the four places P, the plane passes through their
// mean along the normal (P_ahead - P_behind) x (P_left - P_right). The point of contact is that of the plane
// which the four points around the wheel's centre give. The plane is continuous in the position of the wheel
// on a road without steps; a plane road is its own plane.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "common/error.hpp"
#include "mbd_server/forces/tyre_data.hpp"
#include "mbd_server/spatial/triple.hpp"

namespace tandem::mbd {

template <class T>
struct RoadPlane {
  Triple<T> point, normal;
};

// Where the wheel of this centre and axle, a unit vector, is nearest to a plane, in the plane of the wheel.
template <class T>
struct Leg {
  Triple<T> along, down;  // ahead in the road; from the centre to the point of contact [-]
  T sine, cosine;         // of the angles between axle and normal, and of the camber
  T length;               // [m]
};
template <class T>
Leg<T> leg_of(const Triple<T>& centre, const Triple<T>& axle, const RoadPlane<T>& road) {
  using std::sqrt;
  Leg<T> leg;
  const Triple<T> ahead = cross(axle, road.normal);
  leg.sine = sqrt(dot(ahead, ahead));
  leg.along = scaled(T(1) / leg.sine, ahead);
  leg.down = cross(axle, leg.along);
  leg.cosine = -dot(leg.down, road.normal);
  leg.length = dot(difference(centre, road.point), road.normal) / leg.cosine;
  return leg;
}

[[noreturn]] inline void fail_on_road(const TyreOnLink& tyre, const std::string& what,
                                      const std::string& hint) {
  throw Error(ErrorCode::numerics, fmt::format("the wheel of tyre \"{}\" {}", tyre.name, what), "mbd_server",
              hint);
}

// Where the ray through p against `up` begins: at the height of the centre.
template <class T>
Triple<T> begin_of_ray(const TyreOnLink& tyre, const Triple<T>& centre, const Triple<T>& p) {
  const Triple<T> up = triple<T>(tyre.normal);
  return sum(p, scaled(dot(difference(centre, p), up), up));
}

// Where that ray meets the road.
template <class T>
Triple<T> met(const TyreOnLink& tyre, const Triple<T>& centre, const Triple<T>& p) {
  const Triple<T> up = triple<T>(tyre.normal), from = begin_of_ray(tyre, centre, p);
  const std::optional<Road::Place> place = tyre.road->below(numbers(from), tyre.normal);
  if (!place)
    fail_on_road(tyre, "has no road below it",
                 "let the road reach as far as the wheel rolls, and half of patch_length farther");
  const std::string where = fmt::format(" road \"{}\"", place->surface->name);
  if (place->from_behind)
    fail_on_road(tyre, "is inside" + where,
                 "place it above, on the side of the normals; or give more stiffness or damping");
  if (place->normal.dot(tyre.normal) < Road::least_cosine)
    fail_on_road(tyre, "comes to a place of" + where + " that is steeper than 45 degrees to road_normal",
                 "take a rigid wheel for steps and kerbs (shapes with use contact)");
  const Triple<T> n = triple<T>(place->normal);
  const T distance = dot(difference(from, triple<T>(place->point)), n) / T(place->normal.dot(tyre.normal));
  return difference(from, scaled(distance, up));
}

// The four points around p: ahead, behind, left and right.
template <class T>
std::array<Triple<T>, 4> points_around(const TyreOnLink& tyre, const Triple<T>& axle, const Triple<T>& p) {
  using std::sqrt;
  const Triple<T> up = triple<T>(tyre.normal), ahead = cross(axle, up);
  const T size = sqrt(dot(ahead, ahead));
  const Triple<T> along = scaled(T(0.5 * tyre.patch) / size, ahead), across = cross(up, along);
  return {sum(p, along), difference(p, along), sum(p, across), difference(p, across)};
}

// The plane under the four points around p.
template <class T>
RoadPlane<T> plane_around(const TyreOnLink& tyre, const Triple<T>& centre, const Triple<T>& axle,
                          const Triple<T>& p) {
  using std::sqrt;
  const std::array<Triple<T>, 4> around = points_around(tyre, axle, p);
  const Triple<T> front = met(tyre, centre, around[0]), back = met(tyre, centre, around[1]),
                  left = met(tyre, centre, around[2]), right = met(tyre, centre, around[3]);
  for (const auto& [a, b] : {std::pair{&front, &back}, std::pair{&left, &right}})
    if (const RoadSurface* s = tyre.road->step_between(numbers(*a), numbers(*b), tyre.normal))
      fail_on_road(tyre, fmt::format("comes to a step of road \"{}\"", s->name),
                   "take a rigid wheel for steps and kerbs (shapes with use contact)");
  const Triple<T> normal = cross(difference(front, back), difference(left, right));
  return {scaled(T(0.25), sum(sum(front, back), sum(left, right))),
          scaled(T(1) / sqrt(dot(normal, normal)), normal)};
}

// The plane of the road under a wheel. Throws Error{numerics} where there is no road below it, a step, or a
// face steeper than 45 degrees, or where the wheel's centre is inside it.
template <class T>
RoadPlane<T> plane_under(const TyreOnLink& tyre, const Triple<T>& centre, const Triple<T>& axle) {
  const Triple<T> up = triple<T>(tyre.normal);
  if (!tyre.road) return {scaled(T(tyre.height), up), up};
  const RoadPlane<T> first = plane_around(tyre, centre, axle, centre);
  const Leg<T> leg = leg_of(centre, axle, first);
  return plane_around(tyre, centre, axle, sum(centre, scaled(leg.length, leg.down)));
}

}  // namespace tandem::mbd
