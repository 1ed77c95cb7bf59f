// The largest stable step, and the limits within which a weakly compressible liquid may be trusted.
#pragma once

#include "sph_server/equations/liquid.hpp"

namespace tandem::sph {

struct StepLimits {
  double sound = 0;     // 0.3 h / (c0 + v) [s]
  double viscous = 0;   // 0.05 h^2 rho0 / mu, infinite without viscosity [s]
  double force = 0;     // 0.25 sqrt(h / a) [s]
  double smallest = 0;  // [s]
};
// For particles of speed `v` [m/s] and acceleration `a` [m/s2] at most. The step of two stages (Adams and
// Bashforth) bears half the viscous step that [Morris1997] gives for one.
StepLimits step_limits(const Liquid& liquid, double v, double a);

// Weight with which a step of length dt extrapolates the change of a rate since the step before, of length
// `last` [s]: half the ratio of the two, and 0 (first order) for a step of more than twice the last one,
// which would amplify the scatter of the rates. 1/2 for the first step, where `last` is 0.
double extrapolation_weight(double dt, double last);

// Speed of sound at which the density varies by about 1 %: ten times the largest of the speed `v` [m/s] and
// of the speed of free fall over the depth [m].
double suggested_sound_speed(double v, double gravity, double depth);

// Error{scene} where a property is out of its range, with the value and the range.
void expect_liquid(const Liquid& liquid);

}  // namespace tandem::sph
