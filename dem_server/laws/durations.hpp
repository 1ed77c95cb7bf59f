// Limits of stability and durations of collisions by which the laws give theirs.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "common/scene/model.hpp"

namespace tandem::dem {

// Of one sphere [kg].
inline double sphere_mass(double radius, const scene::Material& material) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * material.density;
}

// The stability limit of central differences for an oscillator with damping ratio zeta [s]:
//   T = 2 / omega (sqrt(1 + zeta^2) - zeta)
inline double central_difference_limit(double omega, double zeta) {
  // sqrt(1 + zeta^2) - zeta without cancellation.
  return 2 / omega / (std::sqrt(1 + zeta * zeta) + zeta);
}

// Duration of a collision without damping under the force k d^(3/2), of the reduced mass m* [s]:
//   T = 2.943 (5 m* / (4 k))^(2/5) v^(-1/5)
inline double hertz_collision_time(double reduced_mass, double k, double speed) {
  // 2.943 = 2 times the integral of dx / sqrt(1 - x^(5/2)) from 0 to 1.
  return 2.94327 * std::pow(1.25 * reduced_mass / k, 0.4) * std::pow(speed, -0.2);
}

// The constant that makes a law stiffer, by its key in the scene.
struct StiffnessKey {
  const char* key;
  double scene::Pair::*of_pair;  // null: `young` of the materials
  // An impact of given energy compresses in proportion to that power of the stiffness [-]: by F = k d^(3/2)
  // to d = (5 W / (2 k))^(2/5), by F = k d to d = (2 W / k)^(1/2).
  double overlap_exponent;
};

}  // namespace tandem::dem
