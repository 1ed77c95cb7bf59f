// Numbers of a run that every contact needs: materials and pairs, gravity, quanta of the exact sums.
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/model.hpp"
#include "dem_server/core/fixed_point.hpp"

namespace tandem::dem {

// What the laws need of two materials that meet. All laws read from the same record; a law ignores what it has no use for.
template <class Real>
struct PairConstants {
  Real e_star = 0;      // effective Young's modulus [Pa]: 1/E* = (1-nu_a^2)/E_a + (1-nu_b^2)/E_b
  Real g_star = 0;      // effective shear modulus [Pa]: 1/G* = (2-nu_a)/G_a + (2-nu_b)/G_b
  Real damping = 0;     // alpha of the damped Hertz impact [-], see parameters.cpp
  Real friction = 0;    // [-]
  Real k_n = 0, c_n = 0, k_t = 0, c_t = 0;  // law `paper` [N/m^1.5] [N s/m^1.25]
};

inline constexpr std::uint32_t max_materials = 8;

template <class Real>
struct Parameters {
  PairConstants<Real> pair[max_materials * max_materials];  // row a, column b
  Real mass_per_volume[max_materials]{};  // 4/3 pi density: mass = this r^3 [kg/m3]
  std::uint32_t materials = 0;
  std::uint32_t law = 0;                  // scene::ContactLaw, for the generic variant
  Vec3d gravity;                          // [m/s2]
  Vec3d domain_min, domain_max;           // [m]
  Quantum force, torque;                  // of wall loads [N] [N m]
  double force_limit = 0;                 // largest wall force that the exact sums admit [N]
  float speed_limit = 0;                  // beyond it a run has failed [m/s]
};

// Error{scene} for more materials than the table holds.
template <class Real>
Parameters<Real> make_parameters(const scene::Scene& scene, std::size_t spheres, double largest_radius, double extent);

}  // namespace tandem::dem
