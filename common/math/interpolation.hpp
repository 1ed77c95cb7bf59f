// Functions through given points: x increasing, at least two, and as many y. All but the natural spline stay
// between neighbouring points and are monotone there. Outside the last points they hold the last value,
// but for Ends::straight.
#pragma once

#include <cstddef>
#include <vector>

#include "common/math/piecewise_polynomial.hpp"

namespace tandem {

using Points = std::vector<double>;

// Monotone cubic (Fritsch and Carlson, SIAM J. Numer. Anal. 17, 1980) with the slopes of Fritsch and Butland
// (SIAM J. Sci. Stat. Comput. 5, 1984) in Brodlie's form: the first derivative is continuous between the last
// points. Ends::flat: it is zero there. Ends::held, Ends::straight: it is that of the chord there, and
// outside the curve holds the value or is continued by a straight line.
enum class Ends { flat, held, straight };
PiecewisePolynomial monotone_cubic(const Points& x, const Points& y, Ends ends);

// Monotone quintic: both derivatives are continuous everywhere, and zero at the last points. Slopes p and
// second derivatives r are bounded so that all Bernstein coefficients of the derivative over an interval of
// length h and chord D, which are p0, p0 + h r0/4, 5 D - 2 (p0 + p1) - h (r0 - r1)/4, p1 - h r1/4, p1, have
// the sign of D (compare Dougherty, Edelman, Hyman, Math. Comput. 52, 1989).
PiecewisePolynomial monotone_quintic(const Points& x, const Points& y);

// Natural cubic spline: both derivatives are continuous between the last points, and it overshoots.
PiecewisePolynomial natural_spline(const Points& x, const Points& y);

// Straight between the points.
PiecewisePolynomial linear_interpolation(const Points& x, const Points& y);
// Holds each value until the next x; before the first x it is the first value.
PiecewisePolynomial step_interpolation(const Points& x, const Points& y);

// Weighted means of these two over the last `width`, with the weight 30 s^2 (1 - s)^2 / width, s = (x - x') /
// width in [0, 1]: both derivatives are continuous, zero before the first point, and zero from `width` after
// the last one. `width` is at most the shortest distance of two points.
PiecewisePolynomial smoothed_linear_interpolation(const Points& x, const Points& y, double width);
PiecewisePolynomial smoothed_step_interpolation(const Points& x, const Points& y, double width);

// Where a curve through points leaves them by more than they ask for: between two of them it goes beyond
// both, although the neighbours on the two sides show no extreme there, or further than a quarter of the
// range of the four points about one.
struct Overshoot {
  std::size_t interval = 0;           // between points `interval` and `interval` + 1
  double x = 0, value = 0, size = 0;  // where it is furthest from them, what it is there, and by how much
};
// The largest; of size 0 where all are below 1e-3 of the range of the points.
Overshoot largest_overshoot(const PiecewisePolynomial& curve, const Points& x, const Points& y);

}  // namespace tandem
