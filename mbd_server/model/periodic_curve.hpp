// A function of a joint coordinate, given by a table; with a period it continues beyond both ends.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "common/math/piecewise_polynomial.hpp"

namespace tandem::mbd {

class PeriodicCurve {
 public:
  using Value = PiecewisePolynomial::Value;
  // Interpolation of a table: how often it can be differentiated.
  enum class Smoothness { slope, curvature };

  PeriodicCurve() = default;
  // With a period the arguments cover one. Its last value may differ from the first: then every period adds
  // the difference.
  PeriodicCurve(const std::vector<double>& arguments, const std::vector<double>& values,
                const std::optional<double>& period, Smoothness smoothness);

  Value at(double x) const;
  double largest_slope() const { return largest_slope_; }
  // What a motion from x0 to x1 does not see at its ends: the largest deviation of the curve from the
  // straight line between them, at the knots in between, as a share of the range of the curve.
  double unseen(double x0, double x1) const;

 private:
  PiecewisePolynomial curve_;
  double period_ = 0, begin_ = 0, rise_ = 0, largest_slope_ = 0;
  double range_ = 0;  // of the values at the knots
};

}  // namespace tandem::mbd
