// Functions through given points: x increasing, at least two points, and as many y. All but the natural
// spline stay between neighbouring points and are monotone there. Outside the points they keep the first or
// last value, except for Ends::straight.
#pragma once

#include <cstddef>
#include <vector>

#include "common/math/piecewise_polynomial.hpp"

namespace tandem {

using Points = std::vector<double>;

// Monotone cubic (Fritsch and Carlson, SIAM J. Numer. Anal. 17, 1980) with the slopes of Fritsch and Butland
// (SIAM J. Sci. Stat. Comput. 5, 1984) in Brodlie's form: the first derivative is continuous between the
// first and the last point. Ends::flat: it is zero at these two. Ends::held, Ends::straight: it is that of
// the chord there, and outside the curve keeps the value or continues as a straight line.
enum class Ends { flat, held, straight };
PiecewisePolynomial monotone_cubic(const Points& x, const Points& y, Ends ends);

// Monotone quintic: both derivatives are continuous everywhere, and zero at the first and last point. Slopes
// p and second derivatives r are bounded so that all Bernstein coefficients of the derivative over an
// interval of length h and chord D, which are p0, p0 + h r0/4, 5 D - 2 (p0 + p1) - h (r0 - r1)/4, p1 - h
// r1/4, p1, have the sign of D (compare Dougherty, Edelman, Hyman, Math. Comput. 52, 1989).
PiecewisePolynomial monotone_quintic(const Points& x, const Points& y);

// Natural cubic spline: both derivatives are continuous between the first and the last point, and it
// overshoots.
PiecewisePolynomial natural_spline(const Points& x, const Points& y);

// Straight lines between the points.
PiecewisePolynomial linear_interpolation(const Points& x, const Points& y);
// Holds each value until the next x; before the first x it is the first value.
PiecewisePolynomial step_interpolation(const Points& x, const Points& y);

// Weighted means of these two functions over the last `width`, with the weight 30 s^2 (1 - s)^2 / width,
// s = (x - x') / width in [0, 1]: both derivatives are continuous, zero before the first point, and zero from
// `width` after the last one. `width` is at most the shortest distance between two points.
PiecewisePolynomial smoothed_linear_interpolation(const Points& x, const Points& y, double width);
PiecewisePolynomial smoothed_step_interpolation(const Points& x, const Points& y, double width);

// Where a curve leaves its points by more than they suggest: between two points it exceeds both although the
// neighbours on the two sides show no extreme there, or, about an extreme, by more than a quarter of the
// range of the four points.
struct Overshoot {
  std::size_t interval = 0;           // between points `interval` and `interval` + 1
  double x = 0, value = 0, size = 0;  // position, value and size of the largest deviation
};
// The largest overshoot; its size is 0 where all are below 1e-3 of the range of the points.
Overshoot largest_overshoot(const PiecewisePolynomial& curve, const Points& x, const Points& y);

}  // namespace tandem
