// One window of a scheme as a linear map, for a body in a liquid (docs/coupling.md): a damper, the sound that
// the body radiates, connects it with the mass of the liquid that moves with it. The load answers to the path
// of the walls with a delay, since the liquid takes whole steps.
#pragma once

#include "common/scene/model.hpp"

namespace tandem::launch {

struct LiquidMode {
  double rate = 0;   // R / m, radiation damping over the mass of the body [1/s]
  double ratio = 0;  // m_a / m, added mass over the mass of the body [-]
  double delay = 0;  // of the load, in steps of the liquid [-]
  double step = 0;   // longest of the liquid [s]; a shorter window is one step

  // Of the load in a window [s].
  double delay_in(double window) const;
  // Share of a change of velocity at the begin of a window that the liquid gives back until its end: the
  // impulse over m dv [-].
  double passed(double window) const;
};

// Growth per window: the spectral radius [-]. Stable up to 1. The shapes of load and path are those of the
// mean load, or linear ones in `implicit`.
double growth(const scene::Coupling& how, const LiquidMode& mode, double window);

// The longest window below which every window is stable [s]; 0 where none is, infinite where all are.
double critical_window(const scene::Coupling& how, const LiquidMode& mode);

}  // namespace tandem::launch
