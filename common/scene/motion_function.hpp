// Functions of time of a scene, with their first two derivatives: prescribed joint coordinates and sizes of
// forces.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "common/math/piecewise_polynomial.hpp"
#include "common/scene/model.hpp"

namespace tandem::scene {

// A coordinate and its derivatives [rad or m], [1/s], [1/s2].
struct CoordinateMotion {
  double value = 0, rate = 0, acceleration = 0;
};

// Requirements on the function. A coordinate needs a continuous acceleration: its monotone tables are
// quintic, those of speeds cubic with slopes of zero at the ends, its linear and stepped ones are smoothed.
// Monotone tables of forces are cubic.
enum class FunctionOf { coordinate, force };

class MotionFunction {
 public:
  // Times of a table increase, which validate() has checked. Throws Error{scene} where a table has fewer
  // than two times, or another number of values.
  explicit MotionFunction(const Motion& motion, FunctionOf what = FunctionOf::coordinate);

  // Sees to it that steps of at most that length miss nothing of the function. What is faster than some
  // steps is divided by breaks; where the method is exact for forces that are linear in time, as the
  // trapezoidal rule is, a force or the acceleration of a coordinate is replaced there by one that is linear
  // between the breaks and has the same impulse and its first moment. A signal is a force of which the value
  // between two breaks counts, not its impulse: it keeps its values. `scale`: change of a coordinate that
  // counts as large.
  enum class Steps { trapezoidal, of_high_order };
  enum class Use { force, coordinate, signal };
  void resolve(double longest_step, Steps steps, Use use, double scale);

  CoordinateMotion at(double time) const;
  // Evaluation that does not step over a break: where one is between `side` and `time`, the function of
  // `side` is continued. A break at `side` counts as passed.
  CoordinateMotion at(double time, double side) const;

  // Times at which the value, the rate or, for a coordinate, the acceleration jumps, and both ends of
  // intervals in which a table or ramp changes by more than a tenth of its range: a step that contains such
  // an interval would not see the change. Increasing [s].
  const std::vector<double>& breaks() const { return curve_.breaks(); }
  struct RateJump {
    double time = 0, before = 0, after = 0;  // [s], rates [1/s]
  };
  // Breaks at which the rate jumps: for a coordinate, an impact.
  std::vector<RateJump> rate_jumps() const;
  // Frequency of a harmonic function; 0 for others [1/s].
  double frequency() const { return harmonic_ ? std::abs(harmonic_->frequency) : 0; }
  // Times from begin to end at which the extremes of the function can be, increasing [s].
  std::vector<double> samples(double begin, double end) const;

 private:
  std::optional<HarmonicMotion> harmonic_;  // of a harmonic function; otherwise the curve is used
  PiecewisePolynomial curve_;
};

// The shortest duration of a change that begins at that time: its parts are longer than what is one time to
// the solver. A prescribed position that changes at once has such speeds that the rounding of time, times
// these, would give others an impulse: its share of what is left falls with the square of the duration.
inline double shortest_change(double time, bool of_position) {
  return of_position ? 3e-7 * std::sqrt(1 + std::abs(time)) : 200 * time_resolution(time);
}

// The curve of a table, before integration if it is one of speeds.
PiecewisePolynomial table_curve(const TableMotion& table, FunctionOf what);

}  // namespace tandem::scene
