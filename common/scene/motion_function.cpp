#include "common/scene/motion_function.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "common/math/fast_pieces.hpp"
#include "common/math/interpolation.hpp"

namespace tandem::scene {
namespace {

CoordinateMotion evaluate(const HarmonicMotion& m, double t) {
  const double w = 2 * std::numbers::pi * m.frequency, a = w * t + m.phase;
  return {m.offset + m.amplitude * std::sin(a), m.amplitude * w * std::cos(a),
          -m.amplitude * w * w * std::sin(a)};
}

CoordinateMotion motion(const PiecewisePolynomial::Value& v) {
  return {v.value, v.first, v.second};
}

// offset + the integral from t = 0.
PiecewisePolynomial travelled(const PiecewisePolynomial& speed, double offset) {
  PiecewisePolynomial q = speed.antiderivative();
  q += offset - q.at(0).value;
  return q;
}

struct Curve {
  FunctionOf what;

  PiecewisePolynomial operator()(const ConstantMotion& m) const {
    return {{0}, {{m.value, m.rate}, {m.value, m.rate}}};
  }
  // A monotone quintic through two points has the value and both derivatives of 10 s^3 - 15 s^4 + 6 s^5.
  PiecewisePolynomial operator()(const RampMotion& m) const {
    const PiecewisePolynomial ramp = monotone_quintic({m.start, m.start + m.duration}, {m.from, m.to});
    return m.of == MotionOf::speed ? travelled(ramp, m.offset) : ramp;
  }
  PiecewisePolynomial operator()(const HarmonicMotion&) const { return {}; }
  PiecewisePolynomial operator()(const TableMotion& m) const {
    const PiecewisePolynomial table = table_curve(m, what);
    return m.of == MotionOf::speed ? travelled(table, m.offset) : table;
  }
};

}  // namespace

PiecewisePolynomial table_curve(const TableMotion& m, FunctionOf what) {
  if (m.times.size() < 2 || m.times.size() != m.values.size())
    throw Error(ErrorCode::scene, "a table needs at least two times and as many values", "mbd");
  const bool smooth = what == FunctionOf::coordinate;
  switch (m.interpolation) {
    case Interpolation::linear:
      return smooth ? smoothed_linear_interpolation(m.times, m.values, m.smoothing)
                    : linear_interpolation(m.times, m.values);
    case Interpolation::step:
      return smooth ? smoothed_step_interpolation(m.times, m.values, m.smoothing)
                    : step_interpolation(m.times, m.values);
    case Interpolation::spline:
      return natural_spline(m.times, m.values);
    case Interpolation::monotone:
      break;
  }
  if (!smooth) return monotone_cubic(m.times, m.values, Ends::held);
  return m.of == MotionOf::speed ? monotone_cubic(m.times, m.values, Ends::flat)
                                 : monotone_quintic(m.times, m.values);
}

MotionFunction::MotionFunction(const Motion& motion, FunctionOf what)
    : curve_(std::visit(Curve{what}, motion)) {
  if (const auto* harmonic = std::get_if<HarmonicMotion>(&motion)) harmonic_ = *harmonic;
  curve_.find_breaks(what == FunctionOf::coordinate ? 2 : 1, 0.1);
}

void MotionFunction::resolve(double longest_step, Steps steps, Use use, double scale) {
  const int order = use == Use::coordinate ? 2 : 0;
  const bool trapezoidal = steps == Steps::trapezoidal;
  FastPieces settings{.order = order, .step = longest_step, .scale = scale};
  // The control of a method of high order finds the steps itself once it sees the change.
  settings.parts = !trapezoidal ? 8 : use == Use::signal ? 16 : use == Use::force ? 32 : 64;
  settings.linear_parts = trapezoidal && use != Use::signal;
  const DividedFunction divided = divide_fast_pieces(curve_, settings);
  curve_ = divided.curve;
  curve_.find_breaks(std::max(order, 1), 0.1, divided.fast);
}

CoordinateMotion MotionFunction::at(double time) const {
  return harmonic_ ? evaluate(*harmonic_, time) : motion(curve_.at(time));
}

CoordinateMotion MotionFunction::at(double time, double side) const {
  return harmonic_ ? evaluate(*harmonic_, time) : motion(curve_.at(time, side));
}

std::vector<MotionFunction::RateJump> MotionFunction::rate_jumps() const {
  PiecewisePolynomial first_order = curve_;
  first_order.find_breaks(1);
  std::vector<RateJump> jumps;
  for (std::size_t k = 0; k < curve_.knots().size(); ++k) {
    const double time = curve_.knots()[k];
    if (std::binary_search(first_order.breaks().begin(), first_order.breaks().end(), time))
      jumps.push_back({time, curve_.before(k).first, curve_.after(k).first});
  }
  return jumps;
}

std::vector<double> MotionFunction::samples(double begin, double end) const {
  std::vector<double> marks{begin, end};
  for (const double knot : curve_.knots())
    if (knot > begin && knot < end) marks.push_back(knot);
  // A whole period contains all values of a harmonic function.
  if (harmonic_ && begin + 1 / harmonic_->frequency < end) marks[1] = begin + 1 / harmonic_->frequency;
  std::sort(marks.begin(), marks.end());
  constexpr int parts = 256;
  std::vector<double> times;
  for (std::size_t i = 0; i + 1 < marks.size(); ++i)
    for (int p = 0; p < parts; ++p) times.push_back(marks[i] + (marks[i + 1] - marks[i]) * p / parts);
  times.push_back(marks.back());
  return times;
}

}  // namespace tandem::scene
