#include "mbd_server/joints/motion_function.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

CoordinateMotion evaluate(const scene::ConstantMotion& m, double t) {
  return {m.value + m.rate * t, m.rate, 0};
}

// s(x) = 10 x^3 - 15 x^4 + 6 x^5: first and second derivative vanish at both ends.
CoordinateMotion evaluate(const scene::RampMotion& m, double t) {
  const double x = (t - m.start) / m.duration, d = m.to - m.from, T = m.duration;
  if (x <= 0) return {m.from, 0, 0};
  if (x >= 1) return {m.to, 0, 0};
  return {m.from + d * x * x * x * (10 + x * (-15 + 6 * x)), d / T * 30 * x * x * (1 - x) * (1 - x),
          d / (T * T) * 60 * x * (1 - x) * (1 - 2 * x)};
}

CoordinateMotion evaluate(const scene::HarmonicMotion& m, double t) {
  const double w = 2 * std::numbers::pi * m.frequency, a = w * t + m.phase;
  return {m.offset + m.amplitude * std::sin(a), m.amplitude * w * std::cos(a),
          -m.amplitude * w * w * std::sin(a)};
}

// Second derivatives of the natural cubic spline: the tridiagonal system
// d0 m[i-1] + 2 (d0 + d1) m[i] + d1 m[i+1] = 6 (slope1 - slope0), m = 0 at the ends (Thomas elimination).
std::vector<double> natural_spline(const std::vector<double>& t, const std::vector<double>& y) {
  const std::size_t n = t.size();
  std::vector<double> m(n, 0.0), upper(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double d0 = t[i] - t[i - 1], d1 = t[i + 1] - t[i];
    const double pivot = 2 * (d0 + d1) - d0 * upper[i - 1];
    upper[i] = d1 / pivot;
    m[i] = (6 * ((y[i + 1] - y[i]) / d1 - (y[i] - y[i - 1]) / d0) - d0 * m[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) m[i] -= upper[i] * m[i + 1];
  return m;
}

CoordinateMotion evaluate(const scene::TableMotion& m, double t, const std::vector<double>& curvature) {
  if (t <= m.times.front()) return {m.values.front(), 0, 0};
  if (t >= m.times.back()) return {m.values.back(), 0, 0};
  const auto after = std::upper_bound(m.times.begin(), m.times.end(), t);
  const auto i = static_cast<std::size_t>(after - m.times.begin()) - 1;
  const double d = m.times[i + 1] - m.times[i], b = (t - m.times[i]) / d, a = 1 - b;
  const double y0 = m.values[i], y1 = m.values[i + 1], m0 = curvature[i], m1 = curvature[i + 1];
  return {a * y0 + b * y1 + ((a * a * a - a) * m0 + (b * b * b - b) * m1) * d * d / 6,
          (y1 - y0) / d + ((1 - 3 * a * a) * m0 + (3 * b * b - 1) * m1) * d / 6, a * m0 + b * m1};
}

}  // namespace

MotionFunction::MotionFunction(const scene::Motion& motion) : motion_(motion) {
  if (const auto* table = std::get_if<scene::TableMotion>(&motion_)) {
    if (table->times.size() < 2 || table->times.size() != table->values.size())
      throw Error(ErrorCode::scene, "a motion table needs at least two times and as many values",
                  "mbd.joints");
    curvature_ = natural_spline(table->times, table->values);
  }
}

CoordinateMotion MotionFunction::at(double time) const {
  if (const auto* table = std::get_if<scene::TableMotion>(&motion_))
    return evaluate(*table, time, curvature_);
  if (const auto* constant = std::get_if<scene::ConstantMotion>(&motion_)) return evaluate(*constant, time);
  if (const auto* ramp = std::get_if<scene::RampMotion>(&motion_)) return evaluate(*ramp, time);
  return evaluate(std::get<scene::HarmonicMotion>(motion_), time);
}

}  // namespace tandem::mbd
