// The particles' own books at a window's end: momentum, mass, kinetic energy and contacts, summed exactly.
#pragma once

#include "dem_server/contact/approach.hpp"
#include "dem_server/model/view.hpp"

namespace tandem::dem {

enum Book {
  momentum_x,
  momentum_y,
  momentum_z,
  total_mass,
  kinetic_energy,
  kinetic_energy_rest,  // what its quantum leaves: all of it in a bed at rest
  contact_entries,
  book_count
};

template <class Real, bool spins>
struct Account {
  View<Real> view;
  Quantum momentum, energy;

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
    if (!(of_sphere * energy.inverse < 0x1p61)) return;
    tally.add_book(momentum_x, to_fixed(mass * v.x, momentum));
    tally.add_book(momentum_y, to_fixed(mass * v.y, momentum));
    tally.add_book(momentum_z, to_fixed(mass * v.z, momentum));
    tally.add_book(total_mass, to_fixed(mass, momentum));
    const std::int64_t whole = to_fixed(of_sphere, energy);
    tally.add_book(kinetic_energy, whole);
    tally.add_book(kinetic_energy_rest, to_fixed(of_sphere - from_fixed(whole, energy), energy.of_rests()));
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
