// Spheres and their contacts as they go from rank to rank when lists are rebuilt (engine/engine_ranks.hpp):
//
//   CountTravelling -> sum over all lower indices -> PackTravelling, for each rank that spheres go to
//   Stay: what this rank keeps stays where it is
//   CountArrived    -> sum over all lower indices -> Unpack, behind those that stay
//
// RebuildArrays::order then has the place of each sphere in the order of one process.
#pragma once

#include <algorithm>
#include <cstdint>

#include "dem_server/contact/view.hpp"
#include "dem_server/engine/rank_share.hpp"
#include "dem_server/laws/history.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "dem_server/neighbours/build.hpp"
#include "particles/grid/cell_grid.hpp"
#include "particles/grid/size_levels.hpp"
#include "particles/state/particles.hpp"

namespace tandem::dem {

template <class Real>
struct TravellingSphere {
  PositionRadius<Real> position;
  VelocityKind<Real> velocity;
  Spin<Real> spin;
  FinePart<Real> fine;
  std::uint32_t id = 0, ordinal = 0;      // see RankShare
  std::uint32_t contacts = 0, walls = 0;  // that travel with it
};
// The sphere with the lower ordinal has the contact.
template <class Real>
struct TravellingContact {
  std::uint32_t with = 0;  // ordinal
  Vec3<Real> spring;
  RollingSpring<Real> rolling;
};
template <class Real>
struct TravellingWall {
  std::uint32_t body = 0, facet = 0;
  History<Real> history;
  RollingSpring<Real> rolling;
};

// Numbers of the above.
struct Travelling {
  std::uint32_t spheres = 0, contacts = 0, walls = 0;
  TANDEM_HD friend Travelling operator+(const Travelling& a, const Travelling& b) {
    return {a.spheres + b.spheres, a.contacts + b.contacts, a.walls + b.walls};
  }
  TANDEM_HD friend Travelling operator-(const Travelling& a, const Travelling& b) {
    return {a.spheres - b.spheres, a.contacts - b.contacts, a.walls - b.walls};
  }
};

// A rank that spheres go to, by its range of cells.
template <class Real>
struct Destination {
  Range cells;
  double largest_radius;  // of all spheres [m]

  TANDEM_HD bool has(std::uint32_t cell) const { return cell - cells.begin < cells.end - cells.begin; }

  // Will the rank have sphere i, to move it or as a ghost?
  TANDEM_HD bool needs(const View<Real>& view, std::uint32_t i) const {
    const CellGrid& grid = view.cells();
    const Vec3d x = view.position_in_domain(view.centre(view.window->progress[0].state_side, i));
    const Vec3<std::int32_t> within = cells_around(view, i);
    std::int32_t low[3], high[3];
    bool wraps = false;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = grid.along(x[axis], axis) - within[axis];
      high[axis] = grid.along(x[axis], axis) + within[axis];
      if (grid.periodic[axis]) {
        wraps |= low[axis] < 0 || high[axis] >= grid.cells[axis];
      } else {
        low[axis] = low[axis] < 0 ? 0 : low[axis];
        high[axis] = high[axis] < grid.cells[axis] ? high[axis] : grid.cells[axis] - 1;
      }
    }
    if (!wraps) {
      // Numbers ascend along each axis.
      const std::uint32_t first = grid.number(low[0], low[1], low[2]),
                          last = grid.number(high[0], high[1], high[2]);
      if (last < cells.begin || first >= cells.end) return false;
      if (has(first) || has(last)) return true;
    }
    for (std::int32_t z = low[2]; z <= high[2]; ++z)
      for (std::int32_t y = low[1]; y <= high[1]; ++y)
        for (std::int32_t at_x = low[0]; at_x <= high[0]; ++at_x)
          if (has(grid.number(wrapped(grid, at_x, 0), wrapped(grid, y, 1), wrapped(grid, z, 2)))) return true;
    return false;
  }

 private:
  // How many cells away sphere i searches, or is searched from.
  TANDEM_HD Vec3<std::int32_t> cells_around(const View<Real>& view, std::uint32_t i) const {
    Vec3<std::int32_t> within{1, 1, 1};
    if (view.grid.levels == 1) return within;
    // A sphere searches the cells of the finest level that it reaches; the largest one may find it from
    // there.
    const auto& unit = view.parameters.unit;
    const double reach =
        unit.exact_metres(view.spheres.position[view.window->progress[0].state_side][i].radius) +
        largest_radius + unit.exact_metres(unit.count(view.window->skin) + view.parameters.range);
    for (int axis = 0; axis < 3; ++axis) within[axis] = cells_within(view.cells(), axis, (1 + 1e-6) * reach);
    return within;
  }
  TANDEM_HD static std::int32_t wrapped(const CellGrid& grid, std::int32_t c, int axis) {
    const std::int32_t count = grid.cells[axis];
    return grid.periodic[axis] ? ((c % count) + count) % count : c;
  }
};

// Calls found(near, k) for each wall entry k of sphere i that has a history.
template <class Real, class Found>
TANDEM_HD void for_each_carried_wall(const View<Real>& view, std::uint32_t i, const Label& label,
                                     Found found) {
  const std::uint32_t last = view.window->progress[0].stamp - 1;
  const Range bodies = view.near_of(i, label);
  for (std::uint32_t b = bodies.begin; b < bodies.end; ++b) {
    const NearBody near = view.lists.near[b];
    for (std::uint32_t k = near.first; k < near.first + near.count; ++k)
      if (view.lists.walls.history[k].stamp == last) found(near, k);
  }
}

// Counts what goes to a rank of the k-th own sphere: the contacts with spheres always, those with walls to
// the rank that will move it.
template <class Law, class Real>
struct CountTravelling {
  View<Real> view;
  Destination<Real> to;
  Travelling* count;

  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t i = view.spheres.owned.begin + k, side = view.window->progress[0].state_side;
    Travelling& mine = count[k] = {};
    if (is_parked(view.spheres.position[side][i]) || !to.needs(view, i)) return;
    mine.spheres = 1;
    if constexpr (Law::tangential) {
      const Label label = view.spheres.velocity[side][i].label;
      for_each_carried(view, i, label,
                       [&](std::uint32_t with, const Vec3<Real>&, const auto&, std::uint32_t) {
                         if ((with & wall_flag) == 0) ++mine.contacts;
                       });
      if (to.has(cell_of(view, i)))
        for_each_carried_wall(view, i, label, [&](const NearBody&, std::uint32_t) { ++mine.walls; });
    }
  }
};

// To be called with the sums over all lower indices.
template <class Law, class Real>
struct PackTravelling {
  View<Real> view;
  const Travelling* before;  // (own spheres + 1)
  const std::uint32_t* ordinal;
  TravellingSphere<Real>* spheres;
  TravellingContact<Real>* contacts;
  TravellingWall<Real>* walls;

  TANDEM_HD void operator()(std::uint32_t k) const {
    Travelling at = before[k];
    const Travelling end = before[k + 1];
    if (at.spheres == end.spheres) return;
    const std::uint32_t i = view.spheres.owned.begin + k, side = view.window->progress[0].state_side;
    TravellingSphere<Real>& sphere = spheres[at.spheres];
    sphere.position = view.spheres.position[side][i];
    sphere.velocity = view.spheres.velocity[side][i];
    if constexpr (Law::tangential) {
      sphere.spin = view.spheres.spin[side][i];
      sphere.id = sphere.spin.id;
    } else {
      sphere.spin = {};
      sphere.id = view.spheres.id[i];
    }
    sphere.fine = view.spheres.fine_part(i);
    sphere.ordinal = ordinal[i];
    sphere.contacts = end.contacts - at.contacts, sphere.walls = end.walls - at.walls;
    if constexpr (Law::tangential) {
      const auto rolling = [](const auto& list, std::uint32_t entry) {
        return list.rolling != nullptr ? list.rolling[entry] : RollingSpring<Real>{};
      };
      const auto& lists = view.lists;
      for_each_carried(view, i, sphere.velocity.label,
                       [&](std::uint32_t with, const Vec3<Real>& spring, const auto&, std::uint32_t entry) {
                         if ((with & wall_flag) != 0) return;
                         contacts[at.contacts++] = {ordinal[with], spring, rolling(lists.pairs, entry)};
                       });
      if (at.walls == end.walls) return;
      for_each_carried_wall(view, i, sphere.velocity.label, [&](const NearBody& near, std::uint32_t entry) {
        walls[at.walls++] = {near.body, lists.walls.entry[entry], lists.walls.history[entry],
                             rolling(lists.walls, entry)};
      });
    }
  }
};

// Finds spheres by their ordinals: the own ones, and behind them those that have arrived, whose ordinals
// ascend.
template <class Real>
struct FindOrdinal {
  Range owned;
  std::uint32_t first_ordinal;  // of the own spheres, which follow each other
  const TravellingSphere<Real>* arrived;
  std::uint32_t arrivals;
  static constexpr std::uint32_t nowhere = ~0u;

  TANDEM_HD std::uint32_t operator()(std::uint32_t wanted) const {
    if (wanted - first_ordinal < owned.end - owned.begin) return owned.begin + (wanted - first_ordinal);
    std::uint32_t low = 0, high = arrivals;
    while (low < high) {
      const std::uint32_t middle = low + (high - low) / 2;
      if (arrived[middle].ordinal < wanted)
        low = middle + 1;
      else
        high = middle;
    }
    return low < arrivals && arrived[low].ordinal == wanted ? owned.end + low : nowhere;
  }
};

// For each index up to the end of the own spheres: parks the ghosts, which come anew, and the own spheres
// that this rank no longer needs. Contacts of the others with ghosts now refer to those that have arrived.
template <class Law, class Real>
struct Stay {
  View<Real> view;
  Destination<Real> here;
  FindOrdinal<Real> find;
  const std::uint32_t* ordinal;

  TANDEM_HD void operator()(std::uint32_t i) const {
    PositionRadius<Real>& position = view.spheres.position[view.window->progress[0].state_side][i];
    if (!view.spheres.owns(i) || (!is_parked(position) && !here.needs(view, i)))
      position.radius = parked_radius<Real>;
    if (is_parked(position)) return;
    if constexpr (Law::tangential) {
      const Range entries = entries_of(view.lists.pairs.start, i);
      for (std::uint32_t k = entries.begin; k < entries.end; ++k) {
        const Neighbour other = view.lists.pairs.entry[k];
        if (!other.in_contact() || view.spheres.owns(other.index())) continue;
        const std::uint32_t now = find(ordinal[other.index()]);
        view.lists.pairs.entry[k] =
            Neighbour::of(now != find.nowhere ? now : i, now != find.nowhere);  // one of them was taken out
      }
    }
  }
};

template <class Real>
struct CountArrived {
  const TravellingSphere<Real>* arrived;
  Travelling* count;
  TANDEM_HD void operator()(std::uint32_t k) const { count[k] = {1, arrived[k].contacts, arrived[k].walls}; }
};

// Puts the k-th sphere that has arrived behind the own ones, and its contacts behind their lists. Runs for
// k = arrivals, too.
template <class Law, class Real>
struct Unpack {
  View<Real> view;
  FindOrdinal<Real> find;
  ListEnds ends;
  const Travelling* before;
  const TravellingContact<Real>* contacts;
  const TravellingWall<Real>* walls;

  TANDEM_HD void operator()(std::uint32_t k) const {
    const ContactLists<Real>& lists = view.lists;
    const Travelling at = before[k];
    const std::uint32_t i = find.owned.end + k, first_near = ends.near + at.walls;
    lists.pairs.start[i] = ends.pairs + at.contacts;
    if (k == find.arrivals) {
      WindowProgress& window = *view.window;
      window.indices = i;
      window.listed = ends.pairs + at.contacts;
      window.near = first_near;
      return;
    }
    const Travelling end = before[k + 1];
    const TravellingSphere<Real>& sphere = find.arrived[k];
    const std::uint32_t side = view.window->progress[0].state_side;
    view.spheres.position[side][i] = sphere.position;
    VelocityKind<Real> velocity = sphere.velocity;
    velocity.label = Label::of_kind(velocity.kind());
    velocity.label.set_near(first_near, end.walls - at.walls);
    view.spheres.velocity[side][i] = velocity;
    if constexpr (Law::tangential)
      view.spheres.spin[side][i] = sphere.spin;
    else
      view.spheres.id[i] = sphere.id;
    if constexpr (has_fine_part<Real>) view.spheres.fine[i] = sphere.fine;

    for (std::uint32_t c = at.contacts; c < end.contacts; ++c) {
      const std::uint32_t other = find(contacts[c].with), entry = ends.pairs + c;
      // Where the other sphere is not here, neither of the two is moved here, and no list will have them.
      lists.pairs.entry[entry] = Neighbour::of(other != find.nowhere ? other : i, other != find.nowhere);
      lists.pairs.spring[entry] = contacts[c].spring;
      if (lists.pairs.rolling != nullptr) lists.pairs.rolling[entry] = contacts[c].rolling;
    }
    for (std::uint32_t w = at.walls; w < end.walls; ++w) {
      const std::uint32_t entry = ends.walls + w;
      lists.near[ends.near + w] = {i, walls[w].body, entry, 1};
      lists.walls.entry[entry] = walls[w].facet;
      lists.walls.history[entry] = walls[w].history;
      if (lists.walls.rolling != nullptr) lists.walls.rolling[entry] = walls[w].rolling;
    }
  }
};

}  // namespace tandem::dem
