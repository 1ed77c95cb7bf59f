// Building the Verlet lists: spheres are sorted by cell, then every sphere lists the neighbours and the
// facets within its reach plus the skin. Two passes, count and fill, so that no sphere has a largest number
// of neighbours. Contact histories move from the old lists to the new ones. Order of work: engine.hpp,
// rebuild().
//
// The new state is written to the side that is not current; finish_rebuild() then makes it current.
#pragma once

#include "dem_server/geometry/facet_contact.hpp"
#include "dem_server/model/view.hpp"

namespace tandem::dem {

template <class Real>
struct FindCell {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const Vec3d x = view.place[view.control->state_side][i].x;
    const CellGrid& g = view.grid;
    // Parked spheres come last, in no cell.
    view.key[i] = is_parked(x) ? g.total : g.number(g.along(x.x, 0), g.along(x.y, 1), g.along(x.z, 2));
    view.slot[i] = i;
  }
};

template <class Real>
struct MoveSphere {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t side = view.control->state_side, from = view.source[i];
    view.place[side ^ 1][i] = view.place[side][from];
    view.motion[side ^ 1][i] = view.motion[side][from];
  }
};

// Says where each cell's spheres are; cells without any stay empty, as the clearing left them.
template <class Real>
struct MarkCells {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t cell = view.sorted_key[i];
    if (cell == view.grid.total) return;  // parked
    if (i == 0 || view.sorted_key[i - 1] != cell) view.cell[cell].begin = i;
    if (i + 1 == view.n || view.sorted_key[i + 1] != cell) view.cell[cell].end = i + 1;
  }
};

// Calls found(j) for every sphere within reach plus skin of sphere i, in order of cell, then slot.
template <class Real, class Found>
TANDEM_HD void for_each_neighbour(const View<Real>& view, std::uint32_t i, Found found) {
  const Place<Real>* place = view.place[view.control->state_side ^ 1];
  const Place<Real> own = place[i];
  if (is_parked(own.x)) return;
  const CellGrid& g = view.grid;
  const std::int32_t cx = g.along(own.x.x, 0), cy = g.along(own.x.y, 1), cz = g.along(own.x.z, 2);
  for (std::int32_t z = cz - 1; z <= cz + 1; ++z)
    for (std::int32_t y = cy - 1; y <= cy + 1; ++y)
      for (std::int32_t x = cx - 1; x <= cx + 1; ++x) {
        if (x < 0 || y < 0 || z < 0 || x >= g.cells[0] || y >= g.cells[1] || z >= g.cells[2]) continue;
        const CellRange cell = view.cell[g.number(x, y, z)];
        for (std::uint32_t j = cell.begin; j < cell.end; ++j) {
          if (j == i) continue;
          const double reach =
              static_cast<double>(own.radius) + static_cast<double>(place[j].radius) + view.control->skin;
          if (norm2(own.x - place[j].x) < reach * reach) found(j);
        }
      }
}

// Calls found(facet) for every facet within radius plus skin of sphere i, body by body, facets ascending.
template <class Real, class Found>
TANDEM_HD void for_each_facet(const View<Real>& view, std::uint32_t i, Found found) {
  const Place<Real> own = view.place[view.control->state_side ^ 1][i];
  if (is_parked(own.x)) return;
  const double reach = static_cast<double>(own.radius) + view.control->skin;
  for (std::uint32_t slot = 0; slot < view.slots; ++slot) {
    const BodyPose& body = view.pose[view.control->step * view.slots + slot];
    const Vec3d x = body.R.transpose_times(own.x - body.p);
    const NearFacets near =
        near_facets(view.facet_grids[slot], view.facet_cell_start, view.facet_cell_entry, x);
    WallContact touch;
    for (int k = 0; k < near.count; ++k)
      if (touch_facet(view.facets, near[k], x, reach, touch)) found(near[k]);
  }
}

template <class Real>
struct CountEntries {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    std::uint32_t pairs = 0, walls = 0;
    for_each_neighbour(view, i, [&](std::uint32_t) { ++pairs; });
    for_each_facet(view, i, [&](std::uint32_t) { ++walls; });
    view.pair_count[i] = pairs;
    view.wall_count[i] = walls;
    view.near_count[i] = walls > 0 ? 1 : 0;
  }
};

// i = n too: the lists' ends.
template <class Real>
struct PlaceStarts {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t side = view.control->list_side ^ 1;
    view.pairs[side].start[i] = view.pair_count[i];
    view.walls[side].start[i] = view.wall_count[i];
    if (i == view.n) return;
    const std::uint32_t at = view.near_count[i];
    const bool near = view.near_count[i + 1] != at;
    view.near_of[i] = near ? at : not_near;
    if (near && at < view.near_capacity) view.near[at] = i;
  }
};

// Fills both lists; what was touched in the last step brings its history along.
template <class Real, bool histories>
struct FillEntries {
  View<Real> view;

  TANDEM_HD void operator()(std::uint32_t i) const {
    const Control& c = *view.control;
    const ListView<Real>&pairs = view.pairs[c.list_side ^ 1], &walls = view.walls[c.list_side ^ 1];
    if (pairs.start[view.n] > view.pair_capacity || walls.start[view.n] > view.wall_capacity) return;
    const std::uint32_t was = view.source[i];
    std::uint32_t k = pairs.start[i];
    for_each_neighbour(view, i, [&](std::uint32_t j) {
      pairs.entry[k] = j;
      if constexpr (histories) pairs.history[k] = old_pair(c, was, view.source[j]);
      ++k;
    });
    k = walls.start[i];
    for_each_facet(view, i, [&](std::uint32_t facet) {
      walls.entry[k] = facet;
      if constexpr (histories) walls.history[k] = old_wall(c, was, view.facets[facet].patch);
      ++k;
    });
  }

 private:
  TANDEM_HD History<Real> old_pair(const Control& c, std::uint32_t own, std::uint32_t other) const {
    const ListView<Real>& list = view.pairs[c.list_side];
    for (std::uint32_t k = list.start[own]; k < list.start[own + 1]; ++k)
      if (list.entry[k] == other) return list.history[k];
    return {};
  }
  // The first old entry of the same patch holds the patch's history. Every entry of the patch gets a copy, of
  // which only the first is read again.
  TANDEM_HD History<Real> old_wall(const Control& c, std::uint32_t own, std::uint32_t patch) const {
    const ListView<Real>& list = view.walls[c.list_side];
    for (std::uint32_t k = list.start[own]; k < list.start[own + 1]; ++k)
      if (view.facets[list.entry[k]].patch == patch) return list.history[k];
    return {};
  }
};

template <class Real>
struct FinishRebuild {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t) const {
    Control& c = *view.control;
    c.list_entries = view.pairs[c.list_side ^ 1].start[view.n];
    c.wall_entries = view.walls[c.list_side ^ 1].start[view.n];
    c.near_spheres = view.near_count[view.n];
    if (c.list_entries > view.pair_capacity) c.error |= list_overflow;
    if (c.wall_entries > view.wall_capacity || c.near_spheres > view.near_capacity)
      c.error |= wall_list_overflow;
    // The old state and lists are untouched: the host makes room, and the same rebuild is done again.
    if (c.error != 0) return;
    c.state_side ^= 1;
    c.list_side ^= 1;
    c.travel = c.wall_travel = 0;
    c.max_speed2 = 0;
    c.rebuild_due = 0;
    ++c.rebuilds;
  }
};

}  // namespace tandem::dem
