// Sums over the spheres whose centre is in a region (scene::ParticleSensor), between two windows. They are
// exact, so that they have the same bits for every number of threads and back end.
#pragma once

#include "dem_server/engine/account.hpp"
#include "dem_server/engine/engine.hpp"

namespace tandem::dem {

// The sums of a region: those of Total, of which contact_entries counts spheres, and these.
enum RegionTotal {
  region_volume = total_count,
  moment_x,
  moment_y,
  moment_z,
  flow_momentum,
  flow_momentum_rest,
  region_total_count,
};

template <class Real, bool spins>
struct Measure {
  View<Real> view;
  TotalsQuanta quanta;
  MeasuredRegion region;

  template <class Tally>
  TANDEM_HD void operator()(std::uint32_t i, Tally& tally) const {
    const std::uint32_t side = view.window->progress[0].state_side;
    const PositionRadius<Real> own = view.spheres.position[side][i];
    if (is_parked(own) || !view.spheres.owns(i)) return;
    const Vec3d x = view.parameters.periods.wrapped(view.centre(side, i));
    if (!region.contains(x)) return;
    const Vec3d v = view.velocity(side, i);
    const Real radius = view.parameters.radius(own);
    const Inertia inertia = view.parameters.inertia(view.spheres.velocity[side][i].kind(), radius);
    const double w2 = spins ? norm2(view.spheres.spin[side][i].w.template as<double>()) : 0;
    const double energy = 0.5 * (inertia.mass * norm2(v) + w2 / inertia.inverse_moment);
    tally.add_total(contact_entries, 1);
    tally.add_total(total_mass, to_fixed(inertia.mass, quanta.mass));
    // Positions are within the range of velocities, so that the quantum of momentum is fine enough.
    for (int a = 0; a < 3; ++a) tally.add_total(moment_x + a, to_fixed(inertia.mass * x[a], quanta.momentum));
    const double r = radius;
    tally.add_total(region_volume, to_fixed(volume_of_ball * (r * r * r), quanta.volume));
    if (!(energy * quanta.energy.inverse < 0x1p61)) return;  // ends the run in the next step, see Account
    add_momentum(inertia.mass * v, quanta.momentum, tally);
    add_with_rest(kinetic_energy, kinetic_energy_rest, energy, quanta.energy, tally);
    const Vec3d of_region = region.body.v + cross(region.body.w, x - region.body.p);
    const double along = inertia.mass * dot(v - of_region, region.flow);
    add_with_rest(flow_momentum, flow_momentum_rest, along, quanta.momentum, tally);
  }

  static constexpr double volume_of_ball = 4.18879020478639098462;  // 4/3 pi
};

}  // namespace tandem::dem
