// Spheres that come in and go out between two windows. A sphere that goes out is parked, like one that left
// the domain. A sphere that comes in takes an index that holds no sphere.
#pragma once

#include "dem_server/engine/account.hpp"
#include "dem_server/engine/engine.hpp"

namespace tandem::dem {

// Records a sphere that comes in or goes out, and its momentum.
template <class Real, class Tally>
TANDEM_HD void add_passing(const Parameters<Real>& p, std::uint32_t kind, Real radius, Vec3d v,
                           Quantum momentum, Tally& tally) {
  add_momentum(p.inertia(kind, radius).mass * v, momentum, tally);
  tally.add_total(contact_entries, 1);  // counts spheres here
}

template <class Real, class Tally>
TANDEM_HD void park(PositionRadius<Real>& position, Vec3d v, std::uint32_t kind, const Parameters<Real>& p,
                    Quantum momentum, Tally& tally) {
  add_passing(p, kind, p.radius(position), v, momentum, tally);
  position.radius = parked_radius<Real>;
}

// Which spheres leave: those in a region, or those outside a domain that has moved by `shift` [m].
struct InRegion {
  OutletRegion region;

  template <class Real>
  TANDEM_HD bool operator()(const View<Real>& view, std::uint32_t side, std::uint32_t i) const {
    return region.contains(view.parameters.periods.wrapped(view.centre(side, i)));
  }
};
struct OutsideDomain {
  Vec3d shift;

  template <class Real>
  TANDEM_HD bool operator()(const View<Real>& view, std::uint32_t side, std::uint32_t i) const {
    const Parameters<Real>& p = view.parameters;
    return !p.inside_domain(p.centres.joined(view.spheres.position[side][i], view.spheres.fine_part(i)) -
                            p.centres.of(shift));
  }
};

// Parks the spheres that leave, and records their number and momentum.
template <class Real, class Leaves>
struct RemoveSpheres {
  View<Real> view;
  Leaves leaves;
  Quantum momentum;

  template <class Tally>
  TANDEM_HD void operator()(std::uint32_t i, Tally& tally) const {
    const std::uint32_t side = view.window->progress[0].state_side;
    PositionRadius<Real>& position = view.spheres.position[side][i];
    if (is_parked(position) || !view.spheres.owns(i) || !leaves(view, side, i)) return;
    park(position, view.velocity(side, i), view.spheres.velocity[side][i].kind(), view.parameters, momentum,
         tally);
  }
};

// Initialises the new indices from `first` on, which hold no sphere.
template <class Real>
struct ParkFrom {
  View<Real> view;
  std::uint32_t first;

  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t side = view.window->progress[0].state_side, i = first + k;
    view.spheres.position[side][i] = {};
    view.spheres.position[side][i].radius = parked_radius<Real>;
    view.spheres.velocity[side][i] = {};
    view.lists.pairs.start[i + 1] = view.lists.pairs.start[first];
    if (view.lists.mirror_start != nullptr) view.lists.mirror_start[i + 1] = view.lists.mirror_start[first];
  }
};

struct NewSphere {
  Arrival arrival;
  std::uint32_t kind = 0;
};
// Puts new sphere k at index `first` + k, which must hold no sphere, and records number and momentum.
template <class Real, bool spins>
struct InsertSpheres {
  View<Real> view;
  const NewSphere* new_spheres;
  std::uint32_t first;
  Quantum momentum;

  template <class Tally>
  TANDEM_HD void operator()(std::uint32_t k, Tally& tally) const {
    const std::uint32_t side = view.window->progress[0].state_side, i = first + k;
    if (!is_parked(view.spheres.position[side][i])) return;
    const auto& [a, kind] = new_spheres[k];
    const Parameters<Real>& p = view.parameters;
    PositionRadius<Real> position;
    VelocityKind<Real> velocity;
    FinePart<Real> fine;
    position.radius = p.unit.count(a.ball.radius);
    p.centres.split(p.centres.of(a.ball.x), position, fine);
    velocity.label = Label::of_kind(kind);
    set_velocity(a.v, velocity, fine);
    view.spheres.position[side][i] = position;
    view.spheres.velocity[side][i] = velocity;
    if constexpr (spins)
      view.spheres.spin[side][i] = {{}, a.id};
    else
      view.spheres.id[i] = a.id;
    if constexpr (has_fine_part<Real>) view.spheres.fine[i] = fine;
    add_passing(p, kind, p.radius(position), a.v, momentum, tally);
  }
};

// Finds the balls that overlap a sphere. Each row processes a share of the spheres and has its own results:
// taken[row * count + ball].
template <class Real>
struct FindBallsOnSpheres {
  View<Real> view;
  const Ball* balls;
  std::uint32_t count, rows;
  Vec3d low, high;  // of the balls, with their radii [m]
  std::uint8_t* taken;

  TANDEM_HD void operator()(std::uint32_t row) const {
    const WindowProgress& c = *view.window;
    const auto share = [&](std::uint32_t r) {
      return static_cast<std::uint32_t>(std::uint64_t{view.spheres.count} * r / rows);
    };
    for (std::uint32_t i = share(row); i < share(row + 1); ++i) {
      const PositionRadius<Real> position = view.spheres.position[c.progress[0].state_side][i];
      if (is_parked(position)) continue;
      const Periods& periods = view.parameters.periods;
      const Vec3d x = view.centre(c.progress[0].state_side, i);
      const double r = view.parameters.unit.exact_metres(position.radius);
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

// Finds the balls that overlap a wall when the bodies are in these poses.
template <class Real>
struct FindBallsOnWalls {
  View<Real> view;
  const Ball* balls;
  const BodyPose* pose;  // (bodies)
  std::uint8_t* taken;   // (balls)

  TANDEM_HD void operator()(std::uint32_t k) const {
    for (std::uint32_t body = 0; body < view.surface.bodies; ++body) {
      const Vec3d x = pose[body].R.transpose_times(balls[k].x - pose[body].p);
      const NearFacets near =
          near_facets(view.surface.grids[body], view.surface.cell_start, view.surface.cell_facet, x);
      WallContact touch;
      for (int f = 0; f < near.count; ++f)
        if (touch_facet(view.surface.facets, near[f], x, balls[k].radius, touch)) taken[k] = 1;
    }
  }
};

}  // namespace tandem::dem
