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

// As evaluate() at the rate 0, with states that rest there. `kept`: State::z_known of a machine at rest;
// `weight` counts for a multiplier only.
ElementValue at_rest(const Drive& drive, SignalValue target, double s, const StatesOfElement& kept,
                     double weight);
StatesOfElement kept_at_rest(const Drive& drive, double s, const StatesOfElement& z);
ElementDerivatives derivatives(const Drive& drive, SignalValue target, double s, double v,
                               const StatesOfElement& z);
// Whether a rest exists: an integral over a rate that its target asks for grows without end, unless the force
// is limited.
bool can_rest(const Drive& drive, SignalValue target);

}  // namespace tandem::mbd
