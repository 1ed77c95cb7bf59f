// Forces along the line between two points of links, and their derivatives.
#pragma once

#include "mbd_server/forces/instant.hpp"

namespace tandem::mbd {

struct SpringForce {
  Vector3d p_a, p_b;    // ends [m]
  Vector3d on_b;        // force on b; a gets the opposite [N]
  Matrix3d d_distance;  // derivative of on_b with respect to p_b - p_a [N/m]
  Matrix3d d_velocity;  // derivative of on_b with respect to the velocity of p_b relative to p_a [N s/m]
  double energy = 0;    // stored in the spring [J]
};

// The line between two points.
struct Line {
  Vector3d p_a, p_b;                                     // [m]
  Vector3d r_dot;                                        // velocity of p_b relative to p_a [m/s]
  Vector3d n;                                            // from a to b, unit
  double length = 0;                                     // [m]
  double rate() const { return n.dot(r_dot); }           // of the length [m/s]
  bool has_direction() const { return length > 1e-12; }  // else n is none
};
Line line_between(const PointOnBody& a, const PointOnBody& b, const std::vector<LinkMotion>& links);

// A tension, which pulls the ends together, and its derivatives by length and rate.
struct Tension {
  double force = 0;                   // [N]
  double by_length = 0, by_rate = 0;  // [N/m] [N s/m]
};
SpringForce force_along(const Line& line, const Tension& tension);

}  // namespace tandem::mbd
