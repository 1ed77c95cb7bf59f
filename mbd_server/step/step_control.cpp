#include "mbd_server/step/step_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

constexpr double safety = 0.9;
constexpr double integral = 0.7, proportional = 0.4;  // over the order of the local error
constexpr double smallest_factor = 0.2;
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
  return std::max(error.position, std::min(settings_.max_step, vibration * h) * error.velocity);
}

double StepControl::step(ControlledMethod& method, System& system, State& state, double end) const {
  const ControlTraits traits = method.traits();
  bool rejected = false;
  for (double h = proposed(state, end);;) {
    const std::optional<LocalError> estimate = method.try_step(system, state, h);
    const double error = estimate ? weighted(*estimate, h) / settings_.tolerance : 0;
    if (estimate && error <= 1) {
      accept(traits, state, h, error, rejected);
      return h;
    }
    if (estimate && estimate->position <= settings_.tolerance && h <= too_short * settings_.max_step) {
      method.count_unresolved();
      accept(traits, state, h, estimate->position / settings_.tolerance, false);
      return h;
    }
    if (estimate) method.undo(state);
    rejected = true;
    method.count_rejected();
    const double factor =
        estimate ? std::clamp(safety * std::pow(error, -1 / traits.order), smallest_factor, safety)
                 : after_failure;
    if (!(h > shortest(traits))) {
      if (!estimate) method.give_up(system, h);
      throw Error(
          ErrorCode::numerics,
          fmt::format("the error control asks for steps below {:.3g} s at t = {:.9g} s; the local error "
                      "is {:.3g} times the tolerance, largest at {}",
                      shortest(traits), state.time, error,
                      estimate->position < weighted(*estimate, h) ? method.largest_velocity_error(system)
                                                                  : method.largest_position_error(system)),
          "mbd_server", traits.collapsed);
    }
    h = std::max(factor * h, shortest(traits));
  }
}

double StepControl::shortest(const ControlTraits& traits) const {
  return std::max(settings_.min_step, traits.shortest_share * settings_.max_step);
}

void StepControl::accept(const ControlTraits& traits, State& state, double h, double error,
                         bool rejected) const {
  const double now = std::max(error, 1e-8), last = state.last_error > 0 ? state.last_error : now;
  double factor =
      safety * std::pow(now, -integral / traits.order) * std::pow(last, proportional / traits.order);
  factor = std::clamp(factor, smallest_factor, rejected ? 1.0 : traits.largest_factor);
  if (factor > traits.dead_band_low && factor < traits.dead_band_high) factor = 1;
  // A step below the minimum is refused where this step is rejected.
  state.next_step = std::max(factor * h, shortest(traits));
  state.last_error = now;
}

}  // namespace tandem::mbd
