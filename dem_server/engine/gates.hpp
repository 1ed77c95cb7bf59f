// Spheres that come in and go out between two windows. Those that leave are parked, as beyond the domain;
// those that come in take slots that hold none.
#pragma once

#include "dem_server/engine/account.hpp"
#include "dem_server/engine/engine.hpp"

namespace tandem::dem {

TANDEM_HD inline bool contains(const Region& region, Vec3d x) {
  if (region.half_space) return dot(region.normal, x - region.min) > 0;
  return x.x >= region.min.x && x.x < region.max.x && x.y >= region.min.y && x.y < region.max.y &&
         x.z >= region.min.z && x.z < region.max.z;
}

// Books a sphere that passes, and its momentum.
template <class Real, class Tally>
TANDEM_HD void book_passing(const Parameters<Real>& p, std::uint32_t kind, Real radius, Vec3d v,
                            Quantum momentum, Tally& tally) {
  book_momentum(p.inertia(kind, radius).mass * v, momentum, tally);
  tally.add_book(contact_entries, 1);  // of spheres
}

template <class Real, class Tally>
TANDEM_HD void park(Place<Real>& place, Vec3d v, std::uint32_t kind, const Parameters<Real>& p,
                    Quantum momentum, Tally& tally) {
  book_passing(p, kind, p.radius(place), v, momentum, tally);
  place.radius = parked_radius<Real>;
}

// Parks the spheres in a region, and books their number and momentum.
template <class Real>
struct TakeOut {
  View<Real> view;
  Region region;
  Quantum momentum;

  template <class Tally>
  TANDEM_HD void operator()(std::uint32_t i, Tally& tally) const {
    const Control& c = *view.control;
    const std::uint32_t side = c.progress[0].state_side;
    Place<Real>& place = view.place[side][i];
    if (is_parked(place) || !contains(region, view.parameters.periods.wrapped(view.centre(side, i)))) return;
    park(place, view.velocity(side, i), view.drift[side][i].kind(), view.parameters, momentum, tally);
  }
};

// Parks the spheres outside a domain that has moved by `shift`, and books them likewise.
template <class Real>
struct LeaveBehind {
  View<Real> view;
  Vec3d shift;  // [m]
  Quantum momentum;

  template <class Tally>
  TANDEM_HD void operator()(std::uint32_t i, Tally& tally) const {
    const Control& c = *view.control;
    const std::uint32_t side = c.progress[0].state_side;
    Place<Real>& place = view.place[side][i];
    const Parameters<Real>& p = view.parameters;
    if (is_parked(place) ||
        p.inside_domain(p.centres.joined(place, view.remainder_of(i)) - p.centres.of(shift)))
      return;
    park(place, view.velocity(side, i), view.drift[side][i].kind(), p, momentum, tally);
  }
};

// Slots from `first` on are looked at from now on, and hold no sphere.
template <class Real>
struct EmptySlots {
  View<Real> view;
  std::uint32_t first;

  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t side = view.control->progress[0].state_side, i = first + k;
    view.place[side][i] = {};
    view.place[side][i].radius = parked_radius<Real>;
    view.drift[side][i] = {};
    view.pairs.start[i + 1] = view.pairs.start[first];
    if (view.mirror_start != nullptr) view.mirror_start[i + 1] = view.mirror_start[first];
  }
};

struct Entrant {
  Arrival arrival;
  std::uint32_t kind = 0;
};
// Puts entrant k into slot `first` + k, which holds no sphere, and books number and momentum.
template <class Real, bool spins>
struct BringIn {
  View<Real> view;
  const Entrant* entrants;
  std::uint32_t first;
  Quantum momentum;

  template <class Tally>
  TANDEM_HD void operator()(std::uint32_t k, Tally& tally) const {
    const std::uint32_t side = view.control->progress[0].state_side, i = first + k;
    if (!is_parked(view.place[side][i])) return;
    const auto& [a, kind] = entrants[k];
    const Parameters<Real>& p = view.parameters;
    Place<Real> place;
    Drift<Real> drift;
    Remainder<Real> remainder;
    place.radius = p.unit.count(a.ball.radius);
    p.centres.split(p.centres.of(a.ball.x), place, remainder);
    drift.label = Label::of_kind(kind);
    set_velocity(a.v, drift, remainder);
    view.place[side][i] = place;
    view.drift[side][i] = drift;
    if constexpr (spins)
      view.spin[side][i] = {{}, a.id};
    else
      view.id[i] = a.id;
    if constexpr (has_remainder<Real>) view.remainder[i] = remainder;
    book_passing(p, kind, p.radius(place), a.v, momentum, tally);
  }
};

// Which of some balls overlap a sphere? The spheres are shared out in rows, each of which has its own
// answers: taken[row * count + ball].
template <class Real>
struct FindTaken {
  View<Real> view;
  const Ball* balls;
  std::uint32_t count, rows;
  Vec3d low, high;  // of the balls, with their radii [m]
  std::uint8_t* taken;

  TANDEM_HD void operator()(std::uint32_t row) const {
    const Control& c = *view.control;
    const auto share = [&](std::uint32_t r) {
      return static_cast<std::uint32_t>(std::uint64_t{view.n} * r / rows);
    };
    for (std::uint32_t i = share(row); i < share(row + 1); ++i) {
      const Place<Real> place = view.place[c.progress[0].state_side][i];
      if (is_parked(place)) continue;
      const Periods& periods = view.parameters.periods;
      const Vec3d x = view.centre(c.progress[0].state_side, i);
      const double r = view.parameters.unit.exact_metres(place.radius);
      bool near = true;
      for (int a = 0; a < 3; ++a)
        near = near && (periods.length[a] > 0 || (x[a] >= low[a] - r && x[a] <= high[a] + r));
      if (!near) continue;
      for (std::uint32_t k = 0; k < count; ++k) {
        const double reach = r + balls[k].radius;
        if (norm2(periods.shortest(x - balls[k].x)) < reach * reach) taken[std::size_t{row} * count + k] = 1;
      }
    }
  }
};

// Which of them overlap a wall, the bodies being in these poses?
template <class Real>
struct FindWalled {
  View<Real> view;
  const Ball* balls;
  const BodyPose* pose;  // (slots)
  std::uint8_t* taken;   // (balls)

  TANDEM_HD void operator()(std::uint32_t k) const {
    for (std::uint32_t slot = 0; slot < view.slots; ++slot) {
      const Vec3d x = pose[slot].R.transpose_times(balls[k].x - pose[slot].p);
      const NearFacets near =
          near_facets(view.facet_grids[slot], view.facet_cell_start, view.facet_cell_entry, x);
      WallContact touch;
      for (int f = 0; f < near.count; ++f)
        if (touch_facet(view.facets, near[f], x, balls[k].radius, touch)) taken[k] = 1;
    }
  }
};

}  // namespace tandem::dem
