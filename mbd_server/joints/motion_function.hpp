// Prescribed joint coordinates as functions of time, with their first two derivatives.
#pragma once

#include <vector>

#include "common/scene/model.hpp"

namespace tandem::mbd {

// A coordinate and its derivatives [rad or m], [1/s], [1/s2].
struct CoordinateMotion {
  double value = 0, rate = 0, acceleration = 0;
};

class MotionFunction {
 public:
  explicit MotionFunction(const scene::Motion& motion);
  CoordinateMotion at(double time) const;

 private:
  scene::Motion motion_;
  std::vector<double> curvature_;  // second derivatives at the knots of a table [1/s2]
};

}  // namespace tandem::mbd
