// The totals of all particles at the end of a window: momentum, mass, kinetic energy and contacts, summed
// exactly.
#pragma once

#include "dem_server/contact/approach.hpp"
#include "dem_server/contact/view.hpp"

namespace tandem::dem {

// A sum in whole quanta and a sum of the remainders that the rounding to quanta leaves (`_rest`). The
// remainders matter: they are all of the energy of a bed at rest, and much of the momentum of falling
// spheres, which are all rounded alike.
enum Total {
  momentum_x,
  momentum_y,
  momentum_z,
  momentum_x_rest,
  momentum_y_rest,
  momentum_z_rest,
  total_mass,
  kinetic_energy,
  kinetic_energy_rest,
  contact_entries,
  total_count
};
struct TotalsQuanta {
  Quantum momentum, mass, energy, volume;
};

template <class Tally>
TANDEM_HD void add_with_rest(int whole, int rest, double amount, Quantum quantum, Tally& tally) {
  const std::int64_t rounded = to_fixed(amount, quantum);
  tally.add_total(whole, rounded);
  tally.add_total(rest, to_fixed(amount - from_fixed(rounded, quantum), quantum.of_remainders()));
}
template <class Tally>
TANDEM_HD void add_momentum(Vec3d momentum, Quantum quantum, Tally& tally) {
  add_with_rest(momentum_x, momentum_x_rest, momentum.x, quantum, tally);
  add_with_rest(momentum_y, momentum_y_rest, momentum.y, quantum, tally);
  add_with_rest(momentum_z, momentum_z_rest, momentum.z, quantum, tally);
}

template <class Real, bool spins>
struct Account {
  View<Real> view;
  TotalsQuanta quanta;

  template <class Tally>
  TANDEM_HD void operator()(std::uint32_t i, Tally& tally) const {
    const WindowProgress& c = *view.window;
    const std::uint32_t side = c.progress[0].state_side;
    const PositionRadius<Real> own = view.spheres.position[side][i];
    if (is_parked(own) || !view.spheres.owns(i)) return;
    const Vec3d v = view.velocity(side, i);
    const Inertia inertia =
        view.parameters.inertia(view.spheres.velocity[side][i].kind(), view.parameters.radius(own));
    const double mass = inertia.mass;
    const double w2 = spins ? norm2(view.spheres.spin[side][i].w.template as<double>()) : 0;
    const double of_sphere = 0.5 * (mass * norm2(v) + w2 / inertia.inverse_moment);
    // A sphere whose energy is no number or beyond the range of the sums ends the run in its next step.
    if (!(of_sphere * quanta.energy.inverse < 0x1p61)) return;
    add_momentum(mass * v, quanta.momentum, tally);
    tally.add_total(total_mass, to_fixed(mass, quanta.mass));
    add_with_rest(kinetic_energy, kinetic_energy_rest, of_sphere, quanta.energy, tally);
    std::int64_t touching = 0;
    const PairList<Real>& list = view.lists.pairs;
    for (std::uint32_t k = list.start[i]; k < list.start[i + 1]; ++k) {
      PositionRadius<Real> here = own, other = view.spheres.position[side][list.entry[k].index()];
      if (list.image != nullptr) view.parameters.unwrap_pair(here, other, list.image[k]);
      touching += Approach<Real>(here, other).touching();
    }
    tally.add_total(contact_entries, touching);
  }
};

}  // namespace tandem::dem
