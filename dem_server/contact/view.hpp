// Everything that the functors of a run read and write, as plain pointers that are valid on the processor
// that runs them.
#pragma once

#include <cstdint>

#include "dem_server/contact/dissipation.hpp"
#include "dem_server/contact/lists.hpp"
#include "dem_server/contact/parameters.hpp"
#include "dem_server/contact/rebuild_arrays.hpp"
#include "dem_server/contact/wall_sums.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/geometry/path.hpp"
#include "particles/geometry/surface.hpp"
#include "particles/state/sphere_arrays.hpp"
#include "particles/state/window_progress.hpp"

namespace tandem::dem {

// Walls whose surfaces move along themselves. Other scenes have none, and no contact looks further.
struct BeltsView {
  const Vec3d* velocity = nullptr;  // in the body's frame, zero for other walls (steps x bodies) [m/s]
  // Tangential force of the spheres on each belt along that velocity, in quanta (steps x bodies)
  std::int64_t* pull = nullptr;

  TANDEM_HD bool any() const { return velocity != nullptr; }
};

template <class Real>
struct View {
  SphereArrays<Real> spheres;
  WindowProgress* window = nullptr;
  bool follows = false;         // the domain follows a body
  Parameters<Real> parameters;  // by value, because kernel arguments need no load, nor a reload after a store
  ContactLists<Real> lists;
  ClosePairs<Real> close;                 // where each pair is evaluated once
  WallForce<Real>* wall_force = nullptr;  // of the present step (window->near)
  GridView<Real> grid;
  RebuildArrays<Real> rebuild;
  const PairExtras<Real>* extras = nullptr;  // (max_materials^2), for the generic variant
  SurfaceView surface;
  const BodyPose* pose = nullptr;  // (steps x bodies)
  BeltsView belts;
  WallSumsView wall_sums;
  DissipationView dissipation;
  // Force and torque on each body in quanta (steps x (bodies + 1) x 6). Row `bodies` of a step records the
  // spheres that left the domain: as force their momentum; as torque x their mass times the micro steps that
  // they stayed in this window.
  std::int64_t* load = nullptr;
  std::int64_t* totals = nullptr;  // (total_count), see engine/account.hpp

  TANDEM_HD const CellGrid& cells() const { return grid.finest[window->skin > window->skins.usual ? 1 : 0]; }
  // Position x relative to the domain, expressed where the domain was at the start [m].
  TANDEM_HD Vec3d position_in_domain(Vec3d x) const { return follows ? x - window->domain_shift : x; }
  TANDEM_HD bool inside_domain(typename CentreUnit<Real>::Centre x) const {
    if (follows) x -= parameters.centres.of(window->domain_shift);
    return parameters.inside_domain(x);
  }

  // Entries of `lists.near` of sphere i, whose label is `label`.
  TANDEM_HD Range near_of(std::uint32_t i, const Label& label) const {
    Range of{label.near_first(), label.near_first() + label.near_count()};
    if (label.near_count() == Label::counted)
      while (of.end < window->near && lists.near[of.end].sphere == i) ++of.end;
    return of;
  }

  // Centre and velocity of sphere i in full resolution. `side` is the current side of the state, except in a
  // rebuild.
  TANDEM_HD Vec3d centre(std::uint32_t side, std::uint32_t i) const {
    return parameters.centre(spheres.position[side][i], spheres.fine_part(i));  // [m]
  }
  TANDEM_HD Vec3d velocity(std::uint32_t side, std::uint32_t i) const {
    return velocity_of(spheres.velocity[side][i], spheres.fine_part(i));  // [m/s]
  }
};

}  // namespace tandem::dem
