// Functions of time in a scene (common/scene/motion_function.hpp evaluates them).
#pragma once

#include <variant>
#include <vector>

namespace tandem::scene {

// Functions of time, for a prescribed joint coordinate or for the size of a force
// (common/scene/motion_function.hpp). For a prescribed coordinate a ramp or a table gives its value, or its
// rate; then the coordinate is offset + the integral of the rate from t = 0.
enum class MotionOf { position, speed };
// How a table is interpolated; a linear or stepped motion is smoothed over a time.
enum class Interpolation { monotone, linear, step, spline };

struct ConstantMotion {
  double value = 0, rate = 0;
};                   // q = value + rate t
struct RampMotion {  // quintic, held outside
  double from = 0, to = 0, start = 0, duration = 0;
  MotionOf of = MotionOf::position;
  double offset = 0;  // for a motion of speed: value at t = 0
};
struct HarmonicMotion {
  double offset = 0, amplitude = 0, frequency = 0, phase = 0;
};                    // offset + A sin(2 pi f t + phase)
struct TableMotion {  // held outside
  std::vector<double> times, values;
  Interpolation interpolation = Interpolation::monotone;  // the parser's default in format 1.0: spline
  double smoothing = 0;                                   // linear and stepped motions only [s]
  MotionOf of = MotionOf::position;
  double offset = 0;  // for a motion of speed: value at t = 0
};
using Motion = std::variant<ConstantMotion, RampMotion, HarmonicMotion, TableMotion>;

}  // namespace tandem::scene
