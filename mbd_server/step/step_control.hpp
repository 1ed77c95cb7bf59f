// Error control: a PI controller (Gustafsson, ACM TOMS 20, 1994) on the local error of the position.
#pragma once

#include "mbd_server/step/generalized_alpha.hpp"

namespace tandem::mbd {

struct StepControlSettings {
  double tolerance = 1e-6;                // local error per step, in System::norm() [-]
  double min_step = 1e-12, max_step = 1;  // [s]
};

class StepControl {
 public:
  explicit StepControl(const StepControlSettings& settings) : settings_(settings) {}

  // One accepted step towards `end`, which it does not pass; the last one ends there but for round-off.
  // Rejected steps leave no trace but a count. All memory of the controller is in the state. Throws
  // Error{numerics} where steps get shorter than min_step. Returns the length of the step.
  double step(GeneralizedAlpha& integrator, System& system, State& state, double end) const;

 private:
  double proposed(const State& state, double end) const;
  void accept(State& state, double h, double error, bool rejected) const;

  StepControlSettings settings_;
};

}  // namespace tandem::mbd
