// Motion of one particle over one step: the method of Adams and Bashforth of second order for velocity and
// compression, so that a step needs the rates at its begin only; the position follows with the mean velocity.
#pragma once

#include <cstdint>

#include "particles/state/centre.hpp"
#include "sph_server/equations/liquid.hpp"
#include "sph_server/equations/spray.hpp"
#include "sph_server/step/arrays.hpp"

namespace tandem::sph {

template <class Real>
struct Advance {
  LiquidArrays<Real> liquid;
  particles::CentreUnit<Real> centres;
  particles::Periods periods;
  Liquid properties;
  double dt = 0;        // [s]
  double weight = 0.5;  // extrapolation_weight() [-]
  double damping = 1;   // factor of velocities [-]; below 1 while particles are packed
  // Pressure of all particles while they are packed [Pa]; the compression then stays as it is. Otherwise 0.
  double packing_pressure = 0;

  TANDEM_HD void operator()(std::uint32_t i) const {
    particles::FinePart<Real> fine = liquid.fine_part(i);
    const Vec3d before = particles::velocity_of(liquid.velocity[i], fine);
    const Vec3d a = (1 + weight) * liquid.acceleration[0][i] - weight * liquid.acceleration[1][i];
    const Vec3d after = damping * (before + dt * a);
    particles::set_velocity(after, liquid.velocity[i], fine);
    auto centre = centres.joined(liquid.position[i], fine);
    Vec3d moved = (0.5 * dt) * (before + after);
    if (liquid.shift) moved += dt * liquid.shift[i].template as<double>();
    centre += centres.of(moved);
    centres.split(centres.wrapped(centre, periods), liquid.position[i], fine);
    if constexpr (particles::has_fine_part<Real>) liquid.fine[i] = fine;
    if (!(packing_pressure > 0))
      liquid.compression[i] += dt * ((1 + weight) * liquid.rate[0][i] - weight * liquid.rate[1][i]);
    liquid.acceleration[1][i] = liquid.acceleration[0][i];
    liquid.rate[1][i] = liquid.rate[0][i];
    update_state(i);
  }

  // What neighbours read, with pressure and volume from the compression. The bulk viscosity and the bound on
  // tension take the rate and the filled part of the step before.
  TANDEM_HD void update_state(std::uint32_t i) const {
    const Liquid& l = properties;
    const double e = liquid.compression[i],
                 pressure = borne(l, elastic_pressure(l, e) + bulk_pressure(l, e, liquid.rate[1][i]),
                                  tension_share(static_cast<double>(liquid.filled[i])));
    liquid.state[i] = {liquid.velocity[i].v,
                       static_cast<Real>(packing_pressure > 0 ? packing_pressure : pressure), liquid.slope[i],
                       static_cast<Real>(l.mass() / (l.density * (1 + e)))};
  }
};

}  // namespace tandem::sph
