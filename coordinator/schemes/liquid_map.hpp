// One window of a scheme as a linear map, for a body in a liquid (docs/coupling.md). The load answers to a
// change of the velocity of the walls as the response of the liquid says: first with the sound that the body
// radiates, in the end with the added mass.
#pragma once

#include <vector>

#include "common/scene/model.hpp"

namespace tandem::launch {

// Response of the load on a body along one direction, over the mass of the body: straight lines between the
// points, from zero at no time; after the last point the load fades.
struct LiquidMode {
  std::vector<double> time, impulse;  // after a step of the velocity by one [s] [-]

  // Impulse until `seconds` after a step of the velocity, where windows have the length `window` [-]. In a
  // window shorter than the first time the liquid takes as much shorter steps, and answers sooner.
  double until(double seconds, double window) const;
  double end_load() const;  // [1/s]
  // The same as the mean over a time [-].
  double mean(double from, double to, double window) const;
  double passed(double window) const { return until(window, window); }
};

// Growth per window: the spectral radius [-]. Stable up to 1. The shapes of load and path are those of the
// mean load, or linear ones in `implicit`.
double growth(const scene::Coupling& how, const LiquidMode& mode, double window);

// The longest window below which every window is stable, to the first time over a thousand [s]; 0 where none
// is, infinite where all are.
double critical_window(const scene::Coupling& how, const LiquidMode& mode);

}  // namespace tandem::launch
