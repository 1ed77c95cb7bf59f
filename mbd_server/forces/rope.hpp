// A rope through points of links, without friction, and its derivatives.
#pragma once

#include "mbd_server/kinematics/kinematics.hpp"

namespace tandem::mbd {

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

}  // namespace tandem::mbd
