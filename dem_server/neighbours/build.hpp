// Building the Verlet lists: spheres are sorted by cell, then every sphere lists the neighbours and the
// facets within its reach plus the skin: those in higher slots, then those in lower ones. A back end that
// evaluates pairs once (`once`) lists the lower ones as a mirror: the entries in which a sphere is the
// neighbour. Two passes, count and fill, so that no sphere has a largest number of neighbours. Contact
// histories move from the old lists to the new ones. Order of work: step/engine_of.hpp, rebuild().
//
// The new state is written to the side that is not current; finish_rebuild() then makes it current.
#pragma once

#include "dem_server/contact/approach.hpp"
#include "dem_server/core/group.hpp"
#include "dem_server/geometry/facet_contact.hpp"
#include "dem_server/model/view.hpp"

namespace tandem::dem {

// Spheres leave a periodic domain between rebuilds, by no more than the skin; a rebuild takes them in again,
// and until the next one the images of neighbours that they meet stay the same.
template <class Law, class Real>
TANDEM_HD Vec3d wrapped(const View<Real>& view, Vec3d x) {
  if constexpr (Law::extended)
    return view.parameters.periods.wrapped(x);
  else
    return x;
}

template <class Law, class Real>
TANDEM_HD Vec3d shortest(const View<Real>& view, Vec3d d) {
  if constexpr (Law::extended)
    return view.parameters.periods.shortest(d);
  else
    return d;
}

template <class Real, class Law>
struct FindCell {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const Control& c = *view.control;
    const Vec3d x = view.place_in_domain(wrapped<Law>(view, view.exact[c.list_side][i].x));
    const CellGrid& g = view.grid;
    // Parked spheres come last, in no cell.
    view.key[i] = is_parked(view.place[c.progress[0].state_side][i])
                      ? g.total
                      : g.number(g.along(x.x, 0), g.along(x.y, 1), g.along(x.z, 2));
    view.slot[i] = i;
  }
};

template <class Real, class Law>
struct MoveSphere {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t side = view.control->progress[0].state_side, list_side = view.control->list_side;
    const std::uint32_t from = view.source[i];
    Place<Real> place = view.place[side][from];
    Exact exact = view.exact[list_side][from];
    exact.x = wrapped<Law>(view, exact.x);
    if constexpr (Law::extended) place = view.parameters.placed(exact.x, place.radius);
    view.place[side ^ 1][i] = place;
    view.drift[side ^ 1][i] = view.drift[side][from];
    if constexpr (Law::tangential) view.spin[side ^ 1][i] = view.spin[side][from];
    view.exact[list_side ^ 1][i] = exact;
    view.id[list_side ^ 1][i] = view.id[list_side][from];
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

enum class Neighbours { before, after, all };  // in lower slots, in higher ones

// May the two touch, `image` of the other one being meant?
template <class Law, class Real>
TANDEM_HD bool may_touch(const Parameters<Real>& p, Place<Real> own, Place<Real> other,
                         [[maybe_unused]] Image image) {
  if constexpr (Law::extended) p.bring_together(own, other, image);
  return Approach<Real>::may_touch(own, other);
}

// Calls found(j, image) for every sphere within reach plus skin of sphere i on one side of it, in a share of
// the cells around it, cell by cell. Spheres are sorted by cell number, so half of the cells suffice.
inline constexpr std::uint32_t cells_around = 27;
template <Neighbours which, class Law, class Real, class Found>
TANDEM_HD void for_each_neighbour(const View<Real>& view, std::uint32_t i, Share cells, Found found) {
  const Place<Real>* place = view.place[view.control->progress[0].state_side ^ 1];
  const Place<Real> own = place[i];
  if (is_parked(own)) return;
  const auto skin = view.parameters.skin;
  const CellGrid& g = view.grid;
  const Exact* exact = view.exact[view.control->list_side ^ 1];
  const Vec3d at = exact[i].x;
  const Vec3d from = view.place_in_domain(at);
  const std::int32_t cx = g.along(from.x, 0), cy = g.along(from.y, 1), cz = g.along(from.z, 2);
  const std::uint32_t home = g.number(cx, cy, cz);
  constexpr bool images = Law::extended;
  std::uint32_t around = 0;
  for (std::int32_t dz = -1; dz <= 1; ++dz)
    for (std::int32_t dy = -1; dy <= 1; ++dy)
      for (std::int32_t dx = -1; dx <= 1; ++dx, ++around) {
        if (around < cells.begin || around >= cells.end) continue;
        std::int32_t x = cx + dx, y = cy + dy, z = cz + dz;
        Image image = 0;
        if (!g.exists<images>(x, 0, image) || !g.exists<images>(y, 1, image) ||
            !g.exists<images>(z, 2, image))
          continue;
        const std::uint32_t number = g.number(x, y, z);
        if (which == Neighbours::before && number > home) continue;
        if (which == Neighbours::after && number < home) continue;
        const CellRange cell = view.cell[number];
        const std::uint32_t begin = which == Neighbours::after && number == home ? i + 1 : cell.begin;
        const std::uint32_t end = which == Neighbours::before && number == home ? i : cell.end;
        for (std::uint32_t j = begin; j < end; ++j) {
          if (j == i) continue;
          Place<Real> here = own, other = place[j];
          if constexpr (images) view.parameters.bring_together(here, other, image);
          if (Approach<Real>::may_touch(here, other, skin) && Approach<Real>(here, other, skin).touching() &&
              (g.apart2 == 0 || norm2(shortest<Law>(view, at - exact[j].x)) < g.apart2))
            found(j, image);
        }
      }
}

// Where a sphere's neighbours go in a list: those that touch now from the front, the others from the back.
// Most steps then find a sphere's contacts side by side.
struct TwoEnds {
  std::uint32_t front, back;
  TANDEM_HD std::uint32_t take(bool touching) { return touching ? front++ : --back; }
  TANDEM_HD void skip(std::uint32_t touching, std::uint32_t others) {
    front += touching;
    back -= others;
  }
};

// Calls found(slot, facet, slack) for every facet within radius plus skin of sphere i, body by body, facets
// ascending. They do not touch before they have come nearer by `slack`, which allows for all rounding.
inline constexpr double reach_rounding = 1e-6;  // [-]
template <class Real, class Found>
TANDEM_HD void for_each_facet(const View<Real>& view, std::uint32_t i, Found found) {
  const Control& c = *view.control;
  const Place<Real> own = view.place[c.progress[0].state_side ^ 1][i];
  if (is_parked(own)) return;
  const Vec3d centre = view.exact[c.list_side ^ 1][i].x;
  // The skin of the control is what the range of adhesion leaves of it for travel.
  const double reach = view.parameters.unit.exact_metres(own.radius) + c.skin +
                       view.parameters.unit.exact_metres(view.parameters.range);
  for (std::uint32_t slot = 0; slot < view.slots; ++slot) {
    const BodyPose& body = view.pose[c.progress[0].step * view.slots + slot];
    const Vec3d x = body.R.transpose_times(centre - body.p);
    const NearFacets near =
        near_facets(view.facet_grids[slot], view.facet_cell_start, view.facet_cell_entry, x);
    WallContact touch;
    for (int k = 0; k < near.count; ++k)
      if (touch_facet(view.facets, near[k], x, reach, touch))
        found(slot, near[k], touch.gap + c.skin - reach_rounding * reach);
  }
}

template <class Real, class Law, bool once>
struct CountPairs {
  View<Real> view;
  template <class Group>
  TANDEM_HD void operator()(std::uint32_t i, const Group& group) const {
    std::uint32_t after = 0, before = 0;
    for_each_neighbour<Neighbours::all, Law>(view, i, group.share(cells_around),
                                             [&](std::uint32_t j, Image) { ++(j > i ? after : before); });
    after = group.sum(after);
    before = group.sum(before);
    if (!group.first()) return;
    view.pair_count[i] = once ? after : after + before;
    view.mirror_count[i] = before;
  }
};

template <class Real>
struct CountWalls {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    std::uint32_t walls = 0, bodies = 0, last = view.slots;
    for_each_facet(view, i, [&](std::uint32_t slot, std::uint32_t, double) {
      ++walls;
      if (slot != last) ++bodies;
      last = slot;
    });
    view.wall_count[i] = walls;
    view.near_count[i] = bodies;
  }
};

// i = n too: the lists' ends.
template <class Real, bool once>
struct PlaceStarts {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t side = view.control->list_side ^ 1;
    view.pairs[side].start[i] = view.pair_count[i];
    if (once) view.mirror_start[i] = view.mirror_count[i];
    view.walls[side].start[i] = view.wall_count[i];
    view.near_start[i] = view.near_count[i];
  }
};

template <class Real>
TANDEM_HD bool lists_fit(const View<Real>& view) {
  const std::uint32_t side = view.control->list_side ^ 1;
  return view.pairs[side].start[view.n] <= view.pair_capacity &&
         view.walls[side].start[view.n] <= view.wall_capacity &&
         view.near_start[view.n] <= view.near_capacity;
}

inline constexpr std::uint32_t no_entry = ~0u;

// turned_round: what was first is now the other one, and what is relative to it changes its sign.
template <class Law, class Real>
TANDEM_HD void bring(const ListView<Real>& to, std::uint32_t k, const ListView<Real>& from, std::uint32_t old,
                     bool turned_round) {
  History<Real> history = old == no_entry ? History<Real>{} : from.history[old];
  if (turned_round) history.spring = -history.spring;
  to.history[k] = history;
  if constexpr (Law::extended)
    if (to.turn != nullptr) {
      Turn<Real> turn = old == no_entry ? Turn<Real>{} : from.turn[old];
      if (turned_round) turn.rolled = -turn.rolled;  // twisting is about the normal, which turns round too
      to.turn[k] = turn;
    }
}

// What was touched in the last step brings its history along.
template <class Real, class Law, bool once>
struct FillPairs {
  View<Real> view;

  template <class Group>
  TANDEM_HD void operator()(std::uint32_t i, const Group& group) const {
    if (!lists_fit(view)) return;
    const Control& c = *view.control;
    const ListView<Real>& pairs = view.pairs[c.list_side ^ 1];
    const std::uint32_t was = view.source[i];
    const Place<Real>* place = view.place[c.progress[0].state_side ^ 1];
    const Place<Real> own = place[i];
    const auto touches = [&](std::uint32_t j, Image image) {
      return may_touch<Law>(view.parameters, own, place[j], image);
    };
    constexpr Neighbours side = once ? Neighbours::after : Neighbours::all;
    const Share cells = group.share(cells_around);
    const std::uint32_t end = pairs.start[i + 1], middle = once ? end : end - view.mirror_count[i];
    TwoEnds after{pairs.start[i], middle}, before{middle, end};
    if constexpr (!Group::alone) {
      std::uint32_t touching_after = 0, other_after = 0, touching_before = 0, other_before = 0;
      for_each_neighbour<side, Law>(view, i, cells, [&](std::uint32_t j, Image image) {
        if (touches(j, image))
          ++(j > i ? touching_after : touching_before);
        else
          ++(j > i ? other_after : other_before);
      });
      after.skip(group.of_lower(touching_after), group.of_lower(other_after));
      before.skip(group.of_lower(touching_before), group.of_lower(other_before));
    }
    for_each_neighbour<side, Law>(view, i, cells, [&](std::uint32_t j, Image image) {
      const std::uint32_t k = (j > i ? after : before).take(touches(j, image));
      pairs.entry[k] = j;
      if constexpr (Law::extended)
        if (pairs.image != nullptr) pairs.image[k] = image;
      if constexpr (Law::tangential) {
        const std::uint32_t other = view.source[j];
        const bool turned_round = once && other < was;
        bring<Law>(pairs, k, view.pairs[c.list_side],
                   turned_round ? old_pair(c, other, was) : old_pair(c, was, other), turned_round);
      }
    });
  }

 private:
  TANDEM_HD std::uint32_t old_pair(const Control& c, std::uint32_t own, std::uint32_t other) const {
    const ListView<Real>& list = view.pairs[c.list_side];
    for (std::uint32_t k = list.start[own]; k < list.start[own + 1]; ++k)
      if (list.entry[k] == other) return k;
    return no_entry;
  }
};

template <class Real, class Law>
struct FillWalls {
  View<Real> view;

  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const Control& c = *view.control;
    const ListView<Real>& walls = view.walls[c.list_side ^ 1];
    std::uint32_t k = walls.start[i];
    NearBody* near = view.near + view.near_start[i];
    std::uint32_t last = view.slots;
    for_each_facet(view, i, [&](std::uint32_t slot, std::uint32_t facet, double slack) {
      if (slot != last) *near++ = {i, slot, k, 0};
      last = slot;
      ++near[-1].count;
      walls.entry[k] = facet;
      view.wall_slack[k] = static_cast<float>(slack);
      if constexpr (Law::tangential)
        bring<Law>(walls, k, view.walls[c.list_side], old_wall(c, view.source[i], view.facets[facet].patch),
                   false);
      ++k;
    });
  }

 private:
  // The first old entry of the same patch holds the patch's history. Every entry of the patch gets a copy, of
  // which only the first is read again.
  TANDEM_HD std::uint32_t old_wall(const Control& c, std::uint32_t own, std::uint32_t patch) const {
    const ListView<Real>& list = view.walls[c.list_side];
    for (std::uint32_t k = list.start[own]; k < list.start[own + 1]; ++k)
      if (view.facets[list.entry[k]].patch == patch) return k;
    return no_entry;
  }
};

// Where each sphere is the other one of a pair.
template <class Real, class Law>
struct FillMirrors {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const ListView<Real>& pairs = view.pairs[view.control->list_side ^ 1];
    const Place<Real>* place = view.place[view.control->progress[0].state_side ^ 1];
    TwoEnds at{view.mirror_start[i], view.mirror_start[i + 1]};
    for_each_neighbour<Neighbours::before, Law>(
        view, i, {0, cells_around}, [&](std::uint32_t j, Image image) {
          std::uint32_t k = pairs.start[j];
          while (pairs.entry[k] != i) ++k;
          view.mirror[at.take(may_touch<Law>(view.parameters, place[i], place[j], image))] = k;
        });
  }
};

template <class Real>
struct FinishRebuild {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t) const {
    Control& c = *view.control;
    c.list_entries = view.pairs[c.list_side ^ 1].start[view.n];
    c.wall_entries = view.walls[c.list_side ^ 1].start[view.n];
    c.near = view.near_start[view.n];
    if (c.list_entries > view.pair_capacity) c.error |= list_overflow;
    if (c.wall_entries > view.wall_capacity || c.near > view.near_capacity) c.error |= wall_list_overflow;
    // The old state and lists are untouched: the host makes room, and the same rebuild is done again.
    if (c.error != 0) return;
    Progress& p = c.progress[0];
    p.state_side ^= 1;
    p.travel = p.wall_travel = 0;
    p.rebuild_due = 0;
    c.list_side ^= 1;
    c.max_speed2[0] = c.max_speed2[1] = p.max_speed2 = 0;
    ++c.rebuilds;
  }
};

}  // namespace tandem::dem
