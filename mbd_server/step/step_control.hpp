// Error control: a PI controller (Gustafsson, ACM TOMS 20, 1994) on the local errors of position and
// velocity,
//   error = max(position, max_step * velocity).
// max_step is the longest time without a check: an error of the velocity made in a short step, such as one in
// an impact, becomes an error of the position in the long steps that follow. In a smooth motion whose
// shortest period is some max_step or longer both errors are equal in size.
#pragma once

#include "mbd_server/step/controlled_method.hpp"

namespace tandem::mbd {

struct StepControlSettings {
  double tolerance = 1e-6;                // local error per step, in System::norm() [-]
  double min_step = 1e-12, max_step = 1;  // [s]
};

class StepControl {
 public:
  explicit StepControl(const StepControlSettings& settings) : settings_(settings) {}

  double tolerance() const { return settings_.tolerance; }

  // Takes one accepted step towards `end` and not past it; the last one ends there up to round-off. Rejected
  // steps change only a counter. All memory of the controller is in the state. Throws Error{numerics} where
  // steps become shorter than min_step, or than the method allows. Returns the length of the step.
  double step(ControlledMethod& method, System& system, State& state, double end) const;

 private:
  double weighted(const LocalError& error, double h) const;
  double proposed(const State& state, double end) const;
  double shortest(const ControlTraits& traits) const;
  void accept(const ControlTraits& traits, State& state, double h, double error, bool rejected) const;

  StepControlSettings settings_;
};

}  // namespace tandem::mbd
