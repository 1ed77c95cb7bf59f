#include "common/math/interpolation.hpp"

#include <algorithm>
#include <cmath>

namespace tandem {
namespace {

using Piece = PiecewisePolynomial::Piece;

// From values and slopes at both ends of an interval of length h.
Piece cubic(double h, double y0, double y1, double p0, double p1) {
  const double chord = (y1 - y0) / h;
  return {y0, p0, (3 * chord - 2 * p0 - p1) / h, (p0 + p1 - 2 * chord) / (h * h)};
}

// The same with the second derivatives.
Piece quintic(double h, double y0, double y1, double p0, double p1, double r0, double r1) {
  const double h2 = h * h, chord = (y1 - y0) / h;
  return {y0,
          p0,
          r0 / 2,
          (10 * chord - 6 * p0 - 4 * p1) / h2 + (r1 - 3 * r0) / (2 * h),
          ((7 * p1 + 8 * p0 - 15 * chord) / h + 1.5 * r0 - r1) / h2,
          ((6 * chord - 3 * (p0 + p1)) / h + (r1 - r0) / 2) / (h2 * h)};
}

// f(i) returns the piece between the points i and i + 1.
template <class F>
PiecewisePolynomial between(const Points& x, Piece first, Piece last, F&& f) {
  std::vector<Piece> pieces{first};
  for (std::size_t i = 0; i + 1 < x.size(); ++i) pieces.push_back(f(i));
  pieces.push_back(last);
  return {x, std::move(pieces)};
}
template <class F>
PiecewisePolynomial between(const Points& x, const Points& y, F&& f) {
  return between(x, {y.front()}, {y.back()}, f);
}

double chord(const Points& x, const Points& y, std::size_t i) {
  return (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
}

// Weighted harmonic mean of the two chords, so that an extreme of the points is an extreme of the curve.
Points inner_slopes(const Points& x, const Points& y) {
  Points slopes(x.size(), 0.0);
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double h0 = x[i] - x[i - 1], h1 = x[i + 1] - x[i], a = chord(x, y, i - 1), b = chord(x, y, i);
    slopes[i] = a * b <= 0 ? 0 : 3 * (h0 + h1) / ((2 * h1 + h0) / a + (h1 + 2 * h0) / b);
  }
  return slopes;
}

// Second derivative at an inner point with slope p: that of the parabola through the neighbours, within the
// bounds of the intervals on its two sides.
double bounded_second(const Points& x, const Points& y, std::size_t i, double p) {
  const double h0 = x[i] - x[i - 1], h1 = x[i + 1] - x[i], a = chord(x, y, i - 1), b = chord(x, y, i);
  double low = -HUGE_VAL, high = HUGE_VAL;
  // side = 1: the interval that begins here, -1: the one that ends here.
  const auto bound = [&](double side, double h, double D) {
    const double sign = D > 0 ? 1 : D < 0 ? -1 : 0;
    // sign (p + side h r / 4) >= 0  and  sign (2 p + side h r / 4) <= 2.5 |D|
    const double least = sign == 0 ? 0 : -4 * sign * p / h,
                 most = sign == 0 ? 0 : (10 * std::abs(D) - 8 * sign * p) / h;
    const double one = sign == 0 ? 0 : least * sign * side, other = most * sign * side;
    low = std::max(low, std::min(one, other)), high = std::min(high, std::max(one, other));
  };
  bound(1, h1, b);
  bound(-1, h0, a);
  return std::clamp(2 * (b - a) / (h0 + h1), low, high);
}

}  // namespace

PiecewisePolynomial monotone_cubic(const Points& x, const Points& y, Ends ends) {
  Points slopes = inner_slopes(x, y);
  if (ends != Ends::flat) slopes.front() = chord(x, y, 0), slopes.back() = chord(x, y, x.size() - 2);
  const bool straight = ends == Ends::straight;
  return between(
      x, {y.front(), straight ? slopes.front() : 0}, {y.back(), straight ? slopes.back() : 0},
      [&](std::size_t i) { return cubic(x[i + 1] - x[i], y[i], y[i + 1], slopes[i], slopes[i + 1]); });
}

PiecewisePolynomial monotone_quintic(const Points& x, const Points& y) {
  Points slopes = inner_slopes(x, y), seconds(x.size(), 0.0);
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double most = 1.25 * std::min(std::abs(chord(x, y, i - 1)), std::abs(chord(x, y, i)));
    slopes[i] = std::clamp(slopes[i], -most, most);
    seconds[i] = bounded_second(x, y, i, slopes[i]);
  }
  return between(x, y, [&](std::size_t i) {
    return quintic(x[i + 1] - x[i], y[i], y[i + 1], slopes[i], slopes[i + 1], seconds[i], seconds[i + 1]);
  });
}

// Second derivatives m: the tridiagonal system
// h0 m[i-1] + 2 (h0 + h1) m[i] + h1 m[i+1] = 6 (chord1 - chord0), m = 0 at the ends (Thomas elimination).
PiecewisePolynomial natural_spline(const Points& x, const Points& y) {
  const std::size_t n = x.size();
  Points m(n, 0.0), upper(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double h0 = x[i] - x[i - 1], h1 = x[i + 1] - x[i];
    const double pivot = 2 * (h0 + h1) - h0 * upper[i - 1];
    upper[i] = h1 / pivot;
    m[i] = (6 * (chord(x, y, i) - chord(x, y, i - 1)) - h0 * m[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) m[i] -= upper[i] * m[i + 1];
  return between(x, y, [&](std::size_t i) {
    const double h = x[i + 1] - x[i];
    return Piece{y[i], chord(x, y, i) - h * (2 * m[i] + m[i + 1]) / 6, m[i] / 2, (m[i + 1] - m[i]) / (6 * h)};
  });
}

PiecewisePolynomial linear_interpolation(const Points& x, const Points& y) {
  return between(x, y, [&](std::size_t i) { return Piece{y[i], chord(x, y, i)}; });
}

PiecewisePolynomial step_interpolation(const Points& x, const Points& y) {
  return between(x, y, [&](std::size_t i) { return Piece{y[i]}; });
}

// After a point there is a blend of length `width`, then the straight line delayed by half of `width`. With S
// = 10 s^3 - 15 s^4 + 6 s^5, the integral of the weight, a change of slope adds its integral.
PiecewisePolynomial smoothed_linear_interpolation(const Points& x, const Points& y, double width) {
  Points knots;
  std::vector<Piece> pieces{{y.front()}};
  double slope = 0;  // before the point
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double next = i + 1 < x.size() ? chord(x, y, i) : 0, late = width / 2, change = next - slope;
    const double w3 = width * width * width;
    knots.push_back(x[i]);
    pieces.push_back({y[i] - late * slope, slope, 0, 0, 2.5 * change / w3, -3 * change / (w3 * width),
                      change / (w3 * width * width)});
    if (i + 1 == x.size() || x[i] + width < x[i + 1]) {
      knots.push_back(x[i] + width);
      pieces.push_back({y[i] + late * next, next});
    }
    slope = next;
  }
  return {std::move(knots), std::move(pieces)};
}

PiecewisePolynomial smoothed_step_interpolation(const Points& x, const Points& y, double width) {
  Points knots;
  std::vector<Piece> pieces{{y.front()}};
  for (std::size_t i = 1; i < x.size(); ++i) {
    knots.push_back(x[i]);
    pieces.push_back(quintic(width, y[i - 1], y[i], 0, 0, 0, 0));
    if (i + 1 == x.size() || x[i] + width < x[i + 1]) {
      knots.push_back(x[i] + width);
      pieces.push_back({y[i]});
    }
  }
  return {std::move(knots), std::move(pieces)};
}

Overshoot largest_overshoot(const PiecewisePolynomial& curve, const Points& x, const Points& y) {
  const auto [least, most] = std::minmax_element(y.begin(), y.end());
  Overshoot largest;
  double limit = 1e-3 * (*most - *least);
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    constexpr int samples = 64;
    for (int s = 1; s < samples; ++s) {
      const double at = x[i] + (x[i + 1] - x[i]) * s / samples, value = curve.at(at).value;
      const double high = std::max(y[i], y[i + 1]), low = std::min(y[i], y[i + 1]);
      const double size = std::max(value - high, low - value);
      if (!(size > limit)) continue;
      if (i > 0 && i + 2 < x.size()) {
        const double rise = value > high ? 1 : -1;
        const bool extreme = rise * (y[i] - y[i - 1]) > 0 && rise * (y[i + 1] - y[i + 2]) > 0;
        const double range = std::max({high, y[i - 1], y[i + 2]}) - std::min({low, y[i - 1], y[i + 2]});
        if (extreme && size <= 0.25 * range) continue;
      }
      largest = {i, at, value, size};
      limit = size;
    }
  }
  return largest;
}

}  // namespace tandem
