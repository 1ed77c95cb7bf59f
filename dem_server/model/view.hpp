// Everything that the functors of a run read and write, as plain pointers that are valid on the processor
// that runs them. [2]: double buffered; Control::state_side and Control::list_side say which half is current.
#pragma once

#include <cstdint>

#include "dem_server/contact/laws/law.hpp"
#include "dem_server/core/control.hpp"
#include "dem_server/geometry/path.hpp"
#include "dem_server/geometry/surface.hpp"
#include "dem_server/model/parameters.hpp"
#include "dem_server/model/particles.hpp"
#include "dem_server/neighbours/cell_grid.hpp"

namespace tandem::dem {

// Lists of one kind: entries of sphere i are [start[i], start[i+1]).
template <class Real>
struct ListView {
  std::uint32_t* start = nullptr;    // (n + 1)
  std::uint32_t* entry = nullptr;    // neighbour slot, or facet
  History<Real>* history = nullptr;  // of each entry; absent for laws without friction
};

// Of all walls on one sphere near them.
template <class Real>
struct alignas(16) WallForce {
  Vec3d force;        // [N]
  Vec3<Real> torque;  // about the sphere's centre [N m]
};
inline constexpr std::uint32_t not_near = ~0u;

template <class Real>
struct View {
  std::uint32_t n = 0;  // spheres
  Control* control = nullptr;
  Parameters<Real> parameters;  // by value: a kernel's arguments need no load and no reload after a store

  Place<Real>* place[2]{};    // (n)
  Motion<Real>* motion[2]{};  // (n)
  ListView<Real> pairs[2], walls[2];
  std::uint32_t* near = nullptr;          // spheres near walls (control->near_spheres)
  std::uint32_t* near_of = nullptr;       // place of each sphere in `near`, or not_near (n)
  WallForce<Real>* wall_force = nullptr;  // of the present step (control->near_spheres)
  std::uint32_t pair_capacity = 0, wall_capacity = 0, near_capacity = 0;

  // Used while lists are built.
  CellGrid grid;
  std::uint32_t *key = nullptr, *sorted_key = nullptr;  // cell number (n)
  std::uint32_t *slot = nullptr, *source = nullptr;     // slot before sorting (n)
  CellRange* cell = nullptr;                            // (grid.total)
  // Entries of each sphere and whether it has walls, then their offsets (n + 1).
  std::uint32_t *pair_count = nullptr, *wall_count = nullptr, *near_count = nullptr;

  // Walls.
  std::uint32_t slots = 0;  // bodies with walls, ground included
  const Facet* facets = nullptr;
  const Patch* patches = nullptr;
  const FacetGrid* facet_grids = nullptr;
  const std::uint32_t *facet_cell_start = nullptr, *facet_cell_entry = nullptr;
  const BodyPose* pose = nullptr;  // (steps x slots)
  std::int64_t* load = nullptr;    // (steps x (slots + 1) x 6) force, torque in quanta; see below
  std::int64_t* books = nullptr;   // (book_count) see step/account.hpp
  // Of each step's loads, row `slots` books spheres that left the domain: momentum as force; as torque x,
  // mass times micro steps that it stayed in this window.
};

}  // namespace tandem::dem
