// One window of a scheme as a linear map, for the model problem of docs/coupling.md: a body of mass m on a
// contact (k, d) that the particles' side computes, with omega^2 = k / m, zeta = d / (2 m omega). The
// spectral radius of this map shows whether a window is too large for a contact.
#pragma once

#include <array>

#include "common/scene/model.hpp"

namespace tandem::launch {

// Position, velocity, acceleration at the window's end, and force held for the next window, in units with
// m = omega = 1.
using WindowState = std::array<double, 4>;
WindowState advance_model(const scene::Coupling& how, double omega_H, double zeta, const WindowState& state);

// Growth per window: the spectral radius [-]. Stable up to 1.
double growth(const scene::Coupling& how, double omega_H, double zeta);

// The largest omega H up to which the window is stable; 0 where it never is, infinite where it always is.
double critical_omega_H(const scene::Coupling& how, double zeta);

}  // namespace tandem::launch
