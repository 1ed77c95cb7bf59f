// One window of a scheme as a linear map, for the model problem of docs/coupling.md: a body of mass m on a
// contact (k, d) that the particles' side computes, with omega^2 = k / m, zeta = d / (2 m omega), and on a
// support that the bodies' side computes. The spectral radius of this map shows whether a window is too large
// for a contact.
#pragma once

#include <array>

#include "common/scene/model.hpp"

namespace tandem::launch {

// Contacts of the body with other bodies and the ground: a force -stiffness x - damping v, in units with
// m = omega = 1.
struct Support {
  double stiffness = 0, damping = 0;  // [-]
  bool empty() const { return stiffness == 0 && damping == 0; }
};

// Position, velocity, acceleration at the window's end, and force held for the next window, in units with
// m = omega = 1.
using WindowState = std::array<double, 4>;
WindowState advance_model(const scene::Coupling& how, double omega_H, double zeta, const Support& support,
                          const WindowState& state);

// Growth per window: the spectral radius [-]. Stable up to 1.
double growth(const scene::Coupling& how, double omega_H, double zeta, const Support& support = {});

// The largest omega H up to which the window is stable; 0 where it never is, infinite where it always is.
// With a support, longer windows may be stable again.
double critical_omega_H(const scene::Coupling& how, double zeta, const Support& support = {});

}  // namespace tandem::launch
