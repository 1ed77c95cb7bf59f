// Properties of a liquid and of its discretisation.
#pragma once

#include "common/math/vec3.hpp"
#include "sph_server/equations/state.hpp"

namespace tandem::sph {

struct Liquid {
  double density = 1000;         // rho0 [kg/m3]
  double viscosity = 0;          // mu, dynamic [Pa s]
  double sound_speed = 0;        // c0 [m/s]
  double spacing = 0;            // edge of the cube that one particle fills [m]
  double smoothing = 1.5;        // h / spacing [-]
  double diffusion = 0.1;        // delta of the density diffusion [-]
  double bulk_viscosity = 0.35;  // in units of rho0 c0 h; damps sound and nothing else [-]
  double artificial = 0;         // alpha of the artificial viscosity, for liquids without viscosity [-]
  double shifting = 0;           // of particles that a flow moves apart, see step/shift.hpp; 0: none [-]
  Vec3d gravity;                 // [m/s2]

  TANDEM_HD double h() const { return smoothing * spacing; }                       // [m]
  TANDEM_HD double support() const { return 2 * h(); }                             // [m]
  TANDEM_HD double mass() const { return density * spacing * spacing * spacing; }  // of a particle [kg]
};

// Kinetic energy and energy of compression of a particle [J].
inline double energy_of(const Liquid& l, Vec3d v, double compression) {
  return l.mass() * (0.5 * norm2(v) + l.sound_speed * l.sound_speed * tait_energy(compression));
}

}  // namespace tandem::sph
