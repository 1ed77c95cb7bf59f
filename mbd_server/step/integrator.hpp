// Interface of the methods that advance a state in time.
#pragma once

#include "mbd_server/state/system.hpp"

namespace tandem::mbd {

class Integrator {
 public:
  virtual ~Integrator() = default;

  // Consistent start from state.q, state.u for steps of length h.
  virtual void start(System& system, State& state, double h) = 0;

  // Call when the forces jump at state.time while q and u are continuous.
  virtual void jump(System& system, State& state) = 0;
  // Call when rates and prescribed coordinates may jump as well; `before` is the state without the jump.
  virtual void jump(System& system, const State& before, State& state) = 0;

  // One step of length h. Throws Error{numerics} when Newton's method does not converge. Does not allocate.
  virtual void step(System& system, State& state, double h) = 0;
};

}  // namespace tandem::mbd
