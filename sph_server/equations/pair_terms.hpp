// What two particles of a liquid do to each other. Every force is antisymmetric to the bit: both particles
// compute it from the same products.
#pragma once

#include "common/math/vec3.hpp"
#include "particles/base/arithmetic.hpp"
#include "sph_server/equations/liquid.hpp"
#include "sph_server/kernel/wendland.hpp"

namespace tandem::sph {

// What neighbours read of a particle besides its position, in as few loads as possible.
template <class Real>
struct alignas(16) ParticleState {
  Vec3<Real> v;       // [m/s]
  Real pressure = 0;  // of the equation of state and of the bulk viscosity, see equations/spray.hpp [Pa]
  Vec3<Real> slope;   // gradient of the pressure, in the step before [Pa/m]
  Real volume = 0;    // m/rho [m3]
};

// Constants of the terms.
template <class Real>
struct PairConstants {
  Kernel<Real> kernel;
  Real support2 = 0;      // [m2]
  Real inverse_mass = 0;  // [1/kg]
  Real viscous = 0;       // 30 mu / R^2 [Pa s/m2]
  Real artificial = 0;    // alpha h c0 rho0 [Pa s]
  Real soft2 = 0;         // 0.01 h^2 [m2]
  Real diffusive = 0;     // 2 delta h / (rho0 c0), of a difference of pressures [m/(kg/m3 m/s)]
  Real inverse_near = 0;  // 1 / W(spacing) [m3]

  static PairConstants of(const Liquid& l) {
    const double h = l.h(), c = l.sound_speed;
    const auto kernel = Kernel<double>::of_support(l.support());
    return {Kernel<Real>::of_support(l.support()),
            static_cast<Real>(l.support() * l.support()),
            static_cast<Real>(1 / l.mass()),
            static_cast<Real>(30 * l.viscosity / (l.support() * l.support())),
            static_cast<Real>(l.artificial * h * c * l.density),
            static_cast<Real>(0.01 * h * h),
            static_cast<Real>(2 * l.diffusion * h / (l.density * c)),
            static_cast<Real>(1 / kernel.value(l.spacing))};
  }
};

template <class Real>
struct PairTerms {
  Real pressure = 0;    // acceleration by pressure, divided by d [1/s2]
  Real viscous = 0;     // and by viscosity [1/s2]
  Real continuity = 0;  // rate of compression by motion, divided by 1 + e [1/s]
  Real diffusion = 0;   // and by density diffusion [1/s]
  Real approach = 0;    // (v_i - v_j) . d [m2/s]
  Real kernel = 0;      // W [1/m3]
  Real gradient = 0;    // (1/r) dW/dr [1/m5]
};

// Terms of particle i from j; d = x_i - x_j, r2 = |d|^2 < support^2.
//   pressure   -V_i V_j (p_i + p_j) grad W / m, the adjoint of
//   continuity V_j (v_i - v_j) . grad W, so that the work of the one is the energy of the other
//   viscosity  V_i V_j (30 mu / R^2) ((v_i - v_j) . d) d (1/r dW/dr) / m, along the line between the two as
//              in [MonaghanGingold1983]: it keeps the angular momentum, and a liquid that turns like a rigid
//              body does not feel it, nor does its free surface. In a space full of liquid it is mu
//              laplace(v) / rho0, since the mean of r^2 over W is R^2 / 5. The weight d d instead of d d /
//              r^2 makes the viscosity of a cubic lattice 1.00 along its axes and 1.04 along its diagonals,
//              instead of 0.93 and 1.10.
//   diffusion  2 delta h c0 (rho_j - rho_i, without the difference that belongs to the mean of the two
//              gradients) (1/r dW/dr) V_j [Antuono2010], as differences of pressure / c0^2. The gradient is
//              that which the momentum equation has, so that a pressure in equilibrium does not diffuse.
template <class Real>
TANDEM_HD PairTerms<Real> pair_terms(const PairConstants<Real>& c, Vec3<Real> d, Real r2,
                                     const ParticleState<Real>& i, const ParticleState<Real>& j) {
  constexpr Real half{0.5}, least{0x1p-100};
  const auto [kernel, gradient] = c.kernel.both(particles::root(r2 > least ? r2 : least));
  const Real volumes = (i.volume * j.volume) * c.inverse_mass, of_j = j.volume * gradient;
  PairTerms<Real> t;
  t.kernel = kernel;
  t.gradient = gradient;
  t.approach = dot(i.v - j.v, d);
  t.pressure = -(volumes * ((i.pressure + j.pressure) * gradient));
  Real viscous = c.viscous;
  if (c.artificial > 0 && t.approach < 0) viscous += c.artificial * particles::reciprocal(r2 + c.soft2);
  t.viscous = (volumes * (viscous * gradient)) * t.approach;
  t.continuity = of_j * t.approach;
  t.diffusion = -(c.diffusive * of_j) * ((j.pressure - i.pressure) + half * dot(i.slope + j.slope, d));
  return t;
}

}  // namespace tandem::sph
