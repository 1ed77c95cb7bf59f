// Sizes of forces that are functions of a joint coordinate or its rate.
#pragma once

#include "mbd_server/kinematics/kinematics.hpp"

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

inline double size_of(const LoadOnLink& load, const State& state, const std::vector<LinkMotion>& links) {
  return load.over ? size_over(*load.over, links[load.over->link].coordinate).value
                   : load.size.at(state.time, state.side).value;
}

}  // namespace tandem::mbd
