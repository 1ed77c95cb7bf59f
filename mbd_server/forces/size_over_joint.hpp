// Sizes of forces that are functions of a joint coordinate or its rate.
#pragma once

#include "mbd_server/kinematics/kinematics.hpp"
#include "mbd_server/state/system.hpp"

namespace tandem::mbd {

// Coordinate and rate of a joint with one freedom, free or prescribed.
inline CoordinateMotion coordinate_of(const Model& model, const State& state, LinkIndex i) {
  const Link& link = model.links[i];
  if (link.motion != none) return model.motions[link.motion].at(state.time, state.side);
  return {state.q[link.q], state.u[link.u], state.udot[link.u]};
}

struct SizeValue {
  double value = 0, slope = 0;  // the latter per coordinate, or per rate
};
inline SizeValue size_over(const SizeOverJoint& over, const CoordinateMotion& coordinate) {
  const PeriodicCurve::Value v = over.curve.at(over.of_rate ? coordinate.rate : coordinate.value);
  return {v.value, v.first};
}

// Derivative of the size by the coordinate, weighted as the iteration matrix.
inline double weighted_slope(const SizeOverJoint& over, const std::vector<LinkMotion>& links,
                             const MatrixWeights& weights) {
  const double by = size_over(over, links[over.link].coordinate).slope;
  return by * (over.of_rate ? weights.damping : weights.stiffness);
}

}  // namespace tandem::mbd
