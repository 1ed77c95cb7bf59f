// The particles' own books at a window's end: momentum, mass, kinetic energy and contacts, summed exactly.
#pragma once

#include "dem_server/contact/approach.hpp"
#include "dem_server/contact/view.hpp"

namespace tandem::dem {

// Each rest is what the quantum of the sum leaves: in a bed at rest all of the energy, and in a fall, where
// all spheres are rounded alike, much of the momentum.
enum Book {
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
  book_count
};
struct BookQuanta {
  Quantum momentum, mass, energy;
};

template <class Tally>
TANDEM_HD void book_with_rest(Book whole, Book rest, double amount, Quantum quantum, Tally& tally) {
  const std::int64_t rounded = to_fixed(amount, quantum);
  tally.add_book(whole, rounded);
  tally.add_book(rest, to_fixed(amount - from_fixed(rounded, quantum), quantum.of_rests()));
}
template <class Tally>
TANDEM_HD void book_momentum(Vec3d momentum, Quantum quantum, Tally& tally) {
  book_with_rest(momentum_x, momentum_x_rest, momentum.x, quantum, tally);
  book_with_rest(momentum_y, momentum_y_rest, momentum.y, quantum, tally);
  book_with_rest(momentum_z, momentum_z_rest, momentum.z, quantum, tally);
}

template <class Real, bool spins>
struct Account {
  View<Real> view;
  BookQuanta quanta;

  template <class Tally>
  TANDEM_HD void operator()(std::uint32_t i, Tally& tally) const {
    const Control& c = *view.control;
    const std::uint32_t side = c.progress[0].state_side;
    const Place<Real> own = view.place[side][i];
    if (is_parked(own)) return;
    const Vec3d v = view.velocity(side, i);
    const Inertia inertia = view.parameters.inertia(view.drift[side][i].kind(), view.parameters.radius(own));
    const double mass = inertia.mass;
    const double w2 = spins ? norm2(view.spin[side][i].w.template as<double>()) : 0;
    const double of_sphere = 0.5 * (mass * norm2(v) + w2 / inertia.inverse_moment);
    // What is no number, or beyond the books' range, ends the run with its next step.
    if (!(of_sphere * quanta.energy.inverse < 0x1p61)) return;
    book_momentum(mass * v, quanta.momentum, tally);
    tally.add_book(total_mass, to_fixed(mass, quanta.mass));
    book_with_rest(kinetic_energy, kinetic_energy_rest, of_sphere, quanta.energy, tally);
    std::int64_t touching = 0;
    const PairList<Real>& list = view.pairs;
    for (std::uint32_t k = list.start[i]; k < list.start[i + 1]; ++k) {
      Place<Real> here = own, other = view.place[side][list.entry[k].slot()];
      if (list.image != nullptr) view.parameters.bring_together(here, other, list.image[k]);
      touching += Approach<Real>(here, other).touching();
    }
    tally.add_book(contact_entries, touching);
  }
};

}  // namespace tandem::dem
