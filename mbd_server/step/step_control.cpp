#include "mbd_server/step/step_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

// The local error is of third order in h.
constexpr double order = 3, safety = 0.9;
constexpr double integral = 0.7 / order, proportional = 0.4 / order;
constexpr double smallest_factor = 0.2, largest_factor = 2;
// A change of step disturbs the filtered acceleration, so that small changes are avoided.
constexpr double dead_band_low = 0.95, dead_band_high = 1.2;
constexpr double after_failure = 0.25;
// A vibration that limits the steps passes through many radians in this number of steps.
constexpr double vibration = 1e4;
// For steps below this share of the longest one, the error of the velocity does not count: it then does not
// fall with the step, but comes from round-off near a singular position, magnified by the inverse sine of its
// angle, or from a velocity that jumps.
constexpr double too_short = 1e-7;

}  // namespace

// Divides the time until `end` into equal steps, no longer than the step of the controller.
double StepControl::proposed(const State& state, double end) const {
  const double left = end - state.time;
  const double wanted = std::min(state.next_step > 0 ? state.next_step : left, settings_.max_step);
  return left / std::max(1.0, std::ceil(left / wanted * (1 - 1e-9)));
}

// An error of the velocity grows into one of the position as long as the motion does not reverse: over the
// longest step, or, for a vibration that limits the steps, over a certain number of these.
double StepControl::weighted(const LocalError& error, double h) const {
  return std::max(
      {error.position, std::min(settings_.max_step, vibration * h) * error.velocity, error.states});
}

double StepControl::step(GeneralizedAlpha& integrator, System& system, State& state, double end) const {
  bool rejected = false;
  for (double h = proposed(state, end);;) {
    const std::optional<LocalError> estimate = integrator.try_step(system, state, h);
    const double error = estimate ? weighted(*estimate, h) / settings_.tolerance : 0;
    if (estimate && error <= 1) {
      accept(state, h, error, rejected);
      return h;
    }
    if (estimate && estimate->position <= settings_.tolerance && h <= too_short * settings_.max_step) {
      integrator.count_unresolved();
      accept(state, h, estimate->position / settings_.tolerance, false);
      return h;
    }
    if (estimate) integrator.undo(state);
    rejected = true;
    integrator.count_rejected();
    const double factor =
        estimate ? std::clamp(safety * std::pow(error, -1 / order), smallest_factor, safety) : after_failure;
    if (!(h > settings_.min_step)) {
      if (!estimate) integrator.give_up(system, h);
      throw Error(
          ErrorCode::numerics,
          fmt::format("the error control asks for steps below {:.3g} s at t = {:.9g} s; the local error "
                      "is {:.3g} times the tolerance, largest at {}",
                      settings_.min_step, state.time, error,
                      estimate->states == weighted(*estimate, h) ? integrator.largest_state_error(system)
                      : estimate->position < weighted(*estimate, h)
                          ? integrator.largest_velocity_error(system)
                          : integrator.largest_position_error(system)),
          "mbd_server",
          "look for a force or motion that jumps there, or give a larger mbd.integrator.error_tolerance or "
          "a smaller mbd.integrator.min_step");
    }
    h = std::max(factor * h, settings_.min_step);
  }
}

void StepControl::accept(State& state, double h, double error, bool rejected) const {
  const double now = std::max(error, 1e-8), last = state.last_error > 0 ? state.last_error : now;
  double factor = safety * std::pow(now, -integral) * std::pow(last, proportional);
  factor = std::clamp(factor, smallest_factor, rejected ? 1.0 : largest_factor);
  if (factor > dead_band_low && factor < dead_band_high) factor = 1;
  // A step below the minimum is refused where this step is rejected.
  state.next_step = std::max(factor * h, settings_.min_step);
  state.last_error = now;
}

}  // namespace tandem::mbd
