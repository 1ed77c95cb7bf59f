// Functions of time for steps that are too long for them. A step sees a function at its two ends only: what
// returns in between, as the acceleration of a ramp does, would have no effect.
#pragma once

#include <cmath>

#include "common/math/piecewise_polynomial.hpp"

namespace tandem {

struct FastPieces {
  // What acts: the function itself (0), or its second derivative (2).
  int order = 0;
  double step = 0;  // the longest step
  // Change of the function that counts as large, where the second derivative acts.
  double scale = HUGE_VAL;
  // How many parts a piece has at least over which what acts is not linear.
  int parts = 1;
  // Whether the function is replaced by one of which what acts is linear in each part and has the same
  // integral and the same first moment: a method that is exact for linear forces then has its exact impulse.
  // Without this only the breaks are new.
  bool linear_parts = false;
};

// Divides the pieces that are shorter than some steps into parts, no longer than a step. Steps must not
// contain the ends of these parts: `fast` marks such knots.
struct DividedFunction {
  PiecewisePolynomial curve;
  std::vector<bool> fast;  // (knots)
};
DividedFunction divide_fast_pieces(const PiecewisePolynomial& curve, const FastPieces& settings);

}  // namespace tandem
