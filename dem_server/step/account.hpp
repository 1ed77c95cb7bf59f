// The particles' own books at a window's end: momentum, mass, kinetic energy and contacts, summed exactly.
#pragma once

#include "dem_server/model/view.hpp"

namespace tandem::dem {

enum Book { momentum_x, momentum_y, momentum_z, total_mass, kinetic_energy, contact_ends, book_count };

template <class Real>
struct Account {
  View<Real> view;
  Quantum momentum, energy;

  template <class Tally>
  TANDEM_HD void operator()(std::uint32_t i, Tally& tally) const {
    const Control& c = *view.control;
    const Place<Real> own = view.place[c.state_side][i];
    if (is_parked(own.x)) return;
    const Motion<Real> motion = view.motion[c.state_side][i];
    const Inertia inertia = view.parameters.inertia(own);
    const double mass = inertia.mass;
    tally.add_book(momentum_x, to_fixed(mass * motion.v.x, momentum));
    tally.add_book(momentum_y, to_fixed(mass * motion.v.y, momentum));
    tally.add_book(momentum_z, to_fixed(mass * motion.v.z, momentum));
    tally.add_book(total_mass, to_fixed(mass, momentum));
    const double w2 = norm2(motion.w.template as<double>());
    tally.add_book(kinetic_energy,
                   to_fixed(0.5 * (mass * norm2(motion.v) + w2 / inertia.inverse_moment), energy));
    std::int64_t touching = 0;
    const ListView<Real>& list = view.pairs[c.list_side];
    for (std::uint32_t k = list.start[i]; k < list.start[i + 1]; ++k) {
      const Place<Real>& other = view.place[c.state_side][list.entry[k]];
      const double reach = static_cast<double>(own.radius) + static_cast<double>(other.radius);
      touching += norm2(own.x - other.x) < reach * reach;
    }
    tally.add_book(contact_ends, touching);
  }
};

}  // namespace tandem::dem
