// Static equilibrium near the given configuration: r(t, q, u = 0, u' = 0, lambda, z) = 0 with phi(t, q) = 0
// and z' = g(t, q, u = 0, z) = 0.
//
// Pseudo-transient continuation [Kelley1998]: each iteration is an implicit step of a strongly damped motion,
//   [K + mu M, G^T; G, 0] [dx; dlambda] = -[r; phi],
// with a weight mu that falls with the accelerations at rest. It goes downhill while it is far away, and ends
// as Newton's method. Joints that nothing holds keep their coordinate. Friction and dampers have no force at
// rest, so that one equilibrium is found where friction would allow a range of them.
//
// States of first order follow from the configuration (forces/element_force.hpp), but for the integrals of
// controlled coordinates, z' = error. These are multipliers: an iteration is an implicit step of z' = error
// as well, whose length grows (the method of multipliers, [Bertsekas1982]).
#pragma once

#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

struct EquilibriumReport {
  int iterations = 0;
  double distance = 0;        // largest change of a coordinate, relative to its scale [-]
  std::string moved;          // that coordinate, in the user's words
  double acceleration = 0;    // that is left, in System::norm() [1/s2]
  double state_change = 0;    // largest change of a state of first order, relative to its scale [-]
  std::string changed_state;  // that state, in the user's words
};

// Moves the state, whose loops are closed, into equilibrium under the loads and prescribed coordinates of its
// time; its rates become zero. Throws Error{scene} where a coordinate is driven at a rate at that time, and
// where the machine moves away without finding an equilibrium, with the coordinate, or where the integral of
// a controller cannot come to rest, with the element.
EquilibriumReport find_equilibrium(const Model& model, MachineSystem& system, State& state);

}  // namespace tandem::mbd
