// Searches the spheres near a sphere while lists are built (neighbours/build.hpp). All spheres have been
// moved to their new indices and are sorted by the cells of the finest level; those of coarser levels are
// listed by the cells of their own level as well (particles/grid/size_levels.hpp).
#pragma once

#include <algorithm>
#include <cstdint>

#include "dem_server/contact/approach.hpp"
#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/group.hpp"

namespace tandem::dem {

template <class Law, class Real>
TANDEM_HD Vec3d shortest(const View<Real>& view, Vec3d d) {
  if constexpr (Law::extended)
    return view.parameters.periods.shortest(d);
  else
    return d;
}

// Centre of the sphere that has been moved to index i; its fine part is still at the old index [m].
template <class Real>
TANDEM_HD Vec3d centre_of(const View<Real>& view, std::uint32_t i) {
  const PositionRadius<Real> position = view.spheres.position[view.window->progress[0].state_side ^ 1][i];
  return view.parameters.centre(position, view.spheres.fine_part(view.rebuild.source[i]));
}

enum class Neighbours {
  before,
  after,
  all
};  // with lower indices, with higher ones; or all, including the sphere itself

// May the sphere touch this `image` of the other one?
template <class Law, class Real>
TANDEM_HD bool may_touch(const Parameters<Real>& p, PositionRadius<Real> own, PositionRadius<Real> other,
                         [[maybe_unused]] Image image) {
  if constexpr (Law::extended) p.unwrap_pair(own, other, image);
  return Approach<Real>::may_touch(own, other);
}

// The cells of a level around a sphere, as runs of numbers: indices in the finest level, positions in
// coarse_index in the others. The note of a run is the image of its spheres. Blocks are four cells wide, so
// that a row of cells is one run for each block that it crosses. With images, each cell is a run of its own.
template <bool images>
class CellsAround {
 public:
  // `within`: number of cells on either side of the sphere's own cell.
  TANDEM_HD CellsAround(const CellGrid& grid, const std::uint32_t* start, Vec3d x, Vec3<std::int32_t> within)
      : grid_(grid), start_(start), within_(within) {
    for (int axis = 0; axis < 3; ++axis) home_[axis] = grid.along(x[axis], axis);
    next_to_it_ = within.x == 1 && within.y == 1 && within.z == 1;
  }
  TANDEM_HD std::uint32_t count() const {
    return static_cast<std::uint32_t>(of_row(within_.x) * across(within_.y) * across(within_.z));
  }
  TANDEM_HD Run operator()(std::uint32_t r) const {
    // Nearly all spheres search only the adjacent cells: constants save divisions by variables.
    return next_to_it_ ? run(r, {1, 1, 1}) : run(r, within_);
  }

 private:
  TANDEM_HD static std::int32_t across(std::int32_t within) { return 2 * within + 1; }
  TANDEM_HD static std::int32_t of_row(std::int32_t within) {
    return images ? across(within) : 2 + within / 2;
  }
  TANDEM_HD Run run(std::uint32_t r, Vec3<std::int32_t> within) const {
    const CellGrid& g = grid_;
    const auto number = static_cast<std::int32_t>(r);
    const std::int32_t part = number % of_row(within.x), row = number / of_row(within.x);
    std::int32_t x = home_[0] - within.x + part, last = x, y = home_[1] - within.y + row % across(within.y),
                 z = home_[2] - within.z + row / across(within.y);
    Image image = 0;
    if (!g.exists<images>(y, 1, image) || !g.exists<images>(z, 2, image)) return {};
    if constexpr (images) {
      if (!g.exists<images>(x, 0, image)) return {};
      last = x;
    } else {
      x = std::max(home_[0] - within.x, 0);
      last = std::min(home_[0] + within.x, g.cells[0] - 1);
      if (part > 0) x = (x | 3) + 1 + 4 * (part - 1);
      last = std::min(last, x | 3);
      if (x > last) return {};
    }
    const std::uint32_t cell = g.number(x, y, z);
    return {start_[cell], start_[cell + 1 + static_cast<std::uint32_t>(last - x)], image};
  }

  const CellGrid& grid_;
  const std::uint32_t* start_;
  Vec3<std::int32_t> within_;
  std::int32_t home_[3]{};
  bool next_to_it_;
};

// Calls found(j, image, is_near) for the spheres around sphere i on one side of it, level by level and cell
// by cell; is_near: within reach plus skin.
template <Neighbours which, class Law, Levels levels, class Real, class Group, class Found>
TANDEM_HD void for_each_neighbour(const View<Real>& view, std::uint32_t i, const Group& group, Found found) {
  const PositionRadius<Real>* position = view.spheres.position[view.window->progress[0].state_side ^ 1];
  const PositionRadius<Real> own = position[i];
  if (is_parked(own)) return;
  const Vec3d at = centre_of(view, i), x = view.position_in_domain(at);
  // The skin begins beyond the distance at which adhesion may still act.
  const auto margin = view.parameters.unit.count(view.window->skin) + view.parameters.range;
  const auto is_near = [&](std::uint32_t j, [[maybe_unused]] Image image, double apart2) {
    PositionRadius<Real> here = own, other = position[j];
    if constexpr (Law::extended) view.parameters.unwrap_pair(here, other, image);
    return Approach<Real>::near(here, other, margin) &&
           (apart2 == 0 || norm2(shortest<Law>(view, at - centre_of(view, j))) < apart2);
  };
  // How many cells to search in a level with spheres of up to this radius, rounding to quanta included.
  const auto within = [&]([[maybe_unused]] const CellGrid& grid, [[maybe_unused]] double largest) {
    Vec3<std::int32_t> cells{1, 1, 1};
    if constexpr (levels == Levels::many) {
      const double own_radius = view.parameters.unit.exact_metres(own.radius);
      if (own_radius > largest)
        for (int axis = 0; axis < 3; ++axis)
          cells[axis] =
              cells_within(grid, axis, own_radius + largest + view.parameters.unit.exact_metres(margin));
    }
    return cells;
  };

  const CellGrid& finest = view.cells();
  const double largest_of_finest = view.parameters.unit.exact_metres(view.grid.largest_of_finest);
  const CellsAround<Law::extended> cells(finest, view.rebuild.cell_start, x,
                                         within(finest, largest_of_finest));
  // Runs of the finest level are indices; clipping them selects the spheres before or after i.
  const auto on_side = [&](std::uint32_t r) {
    Run run = cells(r);
    if constexpr (which == Neighbours::after) run.begin = std::max(run.begin, i + 1);
    if constexpr (which == Neighbours::before) run.end = std::min(run.end, i);
    run.end = std::max(run.begin, run.end);
    return run;
  };
  group.for_each(cells.count(), on_side, [&](std::uint32_t j, std::uint32_t note, bool exists) {
    const Image image = static_cast<Image>(note);
    if constexpr (levels == Levels::many)
      exists = exists && position[j].radius <= view.grid.largest_of_finest;
    found(j, image, exists && j != i && is_near(j, image, finest.apart2));
  });
  if constexpr (levels == Levels::many) {
    for (std::uint32_t k = 0; k + 1 < view.grid.levels; ++k) {
      const CoarseLevel& level = view.grid.coarse[k];
      const CellsAround<Law::extended> in_level(level.grid, view.rebuild.coarse_start + level.first_cell, x,
                                                within(level.grid, level.largest));
      group.for_each(in_level.count(), in_level, [&](std::uint32_t at_j, std::uint32_t note, bool exists) {
        const std::uint32_t j = view.rebuild.coarse_index[at_j];
        const Image image = static_cast<Image>(note);
        if constexpr (which == Neighbours::after) exists = exists && j > i;
        if constexpr (which == Neighbours::before) exists = exists && j < i;
        found(j, image, exists && j != i && is_near(j, image, level.grid.apart2));
      });
    }
  }
}

}  // namespace tandem::dem
