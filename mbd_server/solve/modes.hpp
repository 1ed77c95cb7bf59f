// Natural modes of the machine, linearised about a configuration in which it stays: with x the increments of
// the coordinates that the constraints allow,
//   M x'' + C x' + K x = 0,   x = Re(shape e^(s t)).
// The matrices come from the same analytic derivatives as the integrator's (linearisation.hpp), restricted to
// the null space of the constraints; geometric stiffness, gyroscopic terms and the forces of the constraints
// are included.
//
// States of first order of motors and cylinders are unknowns beside x and x': with s = b x the argument of an
// element, and f and g its force and the rates of its states,
//   M x'' + C x' + K x = sum b^T f_z z,   z' = g_s s + g_v s' + g_z z,
// where C and K are those at constant states.
#pragma once

#include <complex>
#include <vector>

#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

struct Mode {
  std::complex<double> s;  // [1/s]
  // Amplitude of each freedom relative to its scale, the largest being 1 (freedoms) [-].
  Eigen::VectorXcd shape;
  // Amplitude of each state of first order relative to its scale, at that amplitude of the freedoms; where no
  // freedom moves, the largest is 1 (first-order states) [-].
  Eigen::VectorXcd states;

  // |s| / (2 pi) [Hz]
  double frequency() const;
  // -Re s / |s|: below 1 an oscillation that decays, 0 one without damping, negative one that grows [-].
  double damping_ratio() const;
};

struct Modes {
  // By ascending frequency; of each conjugate pair the one with Im s > 0.
  std::vector<Mode> modes;
  int neutral = 0;  // independent coordinates that nothing holds: each has s = 0 twice, or once with a damper
  // Combinations of states and coordinates that no small motion changes, as the mass of oil behind a closed
  // valve: each has s = 0 once.
  int constants = 0;
};

// At a state with multipliers at which all accelerations and the rates of the states of first order are zero;
// Error{scene} where they are not, with the coordinate or state. Dense: for machines of some hundred
// freedoms.
Modes find_modes(const Model& model, MachineSystem& system, State state);

}  // namespace tandem::mbd
