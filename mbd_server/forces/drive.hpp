// The law of a drive: a controlled or given force on one argument.
#pragma once

#include "mbd_server/forces/element_force.hpp"

namespace tandem::mbd {

// Value and rate of a signal.
struct SignalValue {
  double value = 0, rate = 0;
};

// The states and the force. `known` and `weight` as in State::z_known, z_weight; with weight 0 the states are
// `known`.
ElementValue evaluate(const Drive& drive, SignalValue target, double s, double v,
                      const StatesOfElement& known, double weight);

}  // namespace tandem::mbd
