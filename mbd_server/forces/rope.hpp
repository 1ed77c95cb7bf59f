// A rope through points of links, without friction, and its derivatives.
#pragma once

#include <algorithm>

#include "mbd_server/forces/force_element.hpp"

namespace tandem::mbd {

// See scene::Rope.
struct RopeOnLinks {
  std::string name;
  std::vector<PointOnBody> points;  // from one end to the other
  double length = 0;                // [m]
  double stiffness = 0;             // of its whole length [N/m]
  double damping = 0;               // [s/m]
  int account = none;
  // The link whose coordinate takes up the rope, and the length per angle of it; none: there is no drum [m].
  LinkIndex drum = none;
  double per_angle = 0;
  int drum_body = none;  // body of the scene that is the drum

  bool has_drum() const { return drum != none; }
  // Its tension then depends on the coordinate of the drum only.
  bool is_between_drum_and_ground() const {
    return has_drum() &&
           std::all_of(points.begin(), points.end(), [](const PointOnBody& p) { return p.link == 0; });
  }
};

struct RopeForce {
  std::vector<Vector3d> points;      // [m]
  std::vector<Vector3d> directions;  // of the spans, from one point to the next
  std::vector<Vector3d>
      turning;  // rates of the directions: part of the spans' rates across them, per length [1/s]
  std::vector<double> lengths;              // of the spans [m]
  double elongation = 0, rate = 0;          // of the whole rope; negative: it is slack [m], [m/s]
  double tension = 0;                       // [N]
  double per_elongation = 0, per_rate = 0;  // derivatives of the tension [N/m], [N s/m]

  bool is_slack() const { return !(elongation > 0); }
};

struct RopeStretch {
  double elongation = 0, rate = 0;  // [m], [m/s]
};
RopeStretch stretch_of(const RopeOnLinks& rope, const std::vector<LinkMotion>& links);

// Allocates only where `out` is too small. Throws Error{numerics} where two points in succession coincide.
void evaluate(const RopeOnLinks& rope, const std::vector<LinkMotion>& links, RopeForce& out);
// Tension at an elongation e and its rate: k e (1 + c e'), not below zero.
double tension(const RopeOnLinks& rope, double elongation, double rate);
// Power lost in the rope: that of the tension less the rate of the stored energy [W].
double dissipated_power(const RopeOnLinks& rope, double elongation, double rate);

std::shared_ptr<const ForceElement> make_force(RopeOnLinks rope);

}  // namespace tandem::mbd
