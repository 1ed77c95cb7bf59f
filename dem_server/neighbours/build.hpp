// Builds the Verlet lists. Spheres are sorted by cell; every sphere then lists the neighbours and the facets
// within its reach plus the skin: neighbours with higher indices first, then those with lower ones. A back
// end that evaluates each pair once (`once`) lists the lower ones as mirrors: the pair entries in which a
// sphere is the other one. Counting and filling are separate passes, so that the number of neighbours of a
// sphere has no limit. engine/engine_of.hpp, rebuild(), has the order of the passes.
//
// Spheres are moved to the side of the state that is not current, and FinishRebuild makes that side current.
// Single-buffered arrays and lists are updated after the capacity check: the histories of existing contacts
// are saved, the new lists overwrite the old ones, and finally the fine parts and single-buffered ids are
// sorted (neighbours/sort_single_buffered.hpp). Histories are saved in the side of the state that was current
// and, where that is too small, behind the lists. If the lists do not fit, state and lists stay unchanged,
// except that all centres have been wrapped into the periodic domain.
#pragma once

#include <algorithm>
#include <cstdint>
#include <new>

#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "dem_server/neighbours/search.hpp"
#include "particles/base/fetch.hpp"
#include "particles/base/group.hpp"
#include "particles/geometry/facet_contact.hpp"

namespace tandem::dem {

// Runs once, first of all. A rebuild that is repeated with more memory chooses the same skin, because its
// inputs have not changed.
template <class Real>
struct ChooseSkin {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t) const {
    WindowProgress& c = *view.window;
    const StepProgress& p = c.progress[0];
    c.skin = c.skins.best(p.age == 0 ? approach_now(p, c.dt, c.body_speed)
                                     : approached(p, c.dt, c.body_speed) / p.age);
  }
};

// Between rebuilds spheres leave a periodic domain by at most the skin. A rebuild wraps them, and the images
// of listed neighbours stay valid until the next one. Wrapping precedes sorting and the capacity check: if
// the lists do not fit, the same rebuild is repeated before any list is read.
template <class Real>
struct WrapCentres {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const CentreUnit<Real>& centres = view.parameters.centres;
    PositionRadius<Real>& position = view.spheres.position[view.window->progress[0].state_side][i];
    FinePart<Real> fine = view.spheres.fine_part(i);
    centres.split(centres.wrapped(centres.joined(position, fine), view.parameters.periods), position, fine);
    if constexpr (has_fine_part<Real>) view.spheres.fine[i] = fine;
  }
};

// Parked indices come last. They are in cells of their own that are no part of the grid, beyond
// SizeLevels::finest_cells(): a few in each, in the order of their indices.
inline constexpr std::uint32_t indices_per_parked_cell = 64;
template <class Real>
TANDEM_HD std::uint32_t first_parked_cell(const View<Real>& view) {
  return std::max(view.grid.finest[0].total, view.grid.finest[1].total);
}
template <class Real>
TANDEM_HD std::uint32_t cell_of(const View<Real>& view, std::uint32_t i) {
  const WindowProgress& c = *view.window;
  const CellGrid& g = view.cells();
  if (is_parked(view.spheres.position[c.progress[0].state_side][i]))
    return first_parked_cell(view) + i / indices_per_parked_cell;
  const Vec3d x = view.position_in_domain(view.centre(c.progress[0].state_side, i));
  return g.number(g.along(x.x, 0), g.along(x.y, 1), g.along(x.z, 2));
}
template <class Real>
struct FindCell {
  View<Real> view;
  TANDEM_HD std::uint32_t operator()(std::uint32_t i) const { return cell_of(view, i); }
};

template <class Real, class Law>
struct MoveSphere {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t side = view.window->progress[0].state_side;
    const std::uint32_t from = view.rebuild.source[i];
    view.spheres.position[side ^ 1][i] = view.spheres.position[side][from];
    view.spheres.velocity[side ^ 1][i] = view.spheres.velocity[side][from];
    if constexpr (Law::tangential) view.spheres.spin[side ^ 1][i] = view.spheres.spin[side][from];
  }
};

// Cell of the sphere that has been moved to index i. Spheres of the finest level and parked ones come last,
// as above.
template <class Real>
struct FindCoarseCell {
  View<Real> view;
  TANDEM_HD std::uint32_t operator()(std::uint32_t i) const {
    const CoarseLevel *level = view.grid.coarse, *const last = level + (view.grid.levels - 2);
    const PositionRadius<Real> position = view.spheres.position[view.window->progress[0].state_side ^ 1][i];
    if (position.radius <= view.grid.largest_of_finest)
      return last->first_cell + last->grid.total + i / indices_per_parked_cell;
    while (level != last && view.parameters.unit.exact_metres(position.radius) > level->largest) ++level;
    const Vec3d x = view.position_in_domain(centre_of(view, i));
    const CellGrid& g = level->grid;
    return level->first_cell + g.number(g.along(x.x, 0), g.along(x.y, 1), g.along(x.z, 2));
  }
};

// Free part of a list, or of half of one: some neighbours are appended at the front, the others at the back.
struct TwoEnds {
  std::uint32_t front, back;
  // Index of the entry for the neighbour that this thread of the group has found, if it has one.
  template <class Group>
  TANDEM_HD std::uint32_t take(const Group& group, bool has, bool in_front) {
    const std::uint32_t from_front = front + group.before(has && in_front),
                        from_back = back - 1 - group.before(has && !in_front);
    front += group.count(has && in_front);
    back -= group.count(has && !in_front);
    return in_front ? from_front : from_back;
  }
};

// Calls found(body, facet, slack) for every facet within radius plus skin of sphere i, body by body, with
// ascending facets. Sphere and facet are not in contact before they have approached by `slack`, which
// includes all rounding.
inline constexpr double reach_rounding = 1e-6;  // [-]
template <class Real, class Found>
TANDEM_HD void for_each_facet(const View<Real>& view, std::uint32_t i, Found found) {
  const WindowProgress& c = *view.window;
  const PositionRadius<Real> own = view.spheres.position[c.progress[0].state_side ^ 1][i];
  if (is_parked(own) || !view.spheres.owns(i)) return;
  const Vec3d centre = centre_of(view, i);
  const double reach = view.parameters.unit.exact_metres(own.radius) + c.skin +
                       view.parameters.unit.exact_metres(view.parameters.range);
  for (std::uint32_t body = 0; body < view.surface.bodies; ++body) {
    const BodyPose& pose = view.pose[c.progress[0].step * view.surface.bodies + body];
    const Vec3d x = pose.R.transpose_times(centre - pose.p);
    const NearFacets near =
        near_facets(view.surface.grids[body], view.surface.cell_start, view.surface.cell_facet, x);
    WallContact touch;
    for (int k = 0; k < near.count; ++k)
      if (touch_facet(view.surface.facets, near[k], x, reach, touch))
        found(body, near[k], touch.gap + c.skin - reach_rounding * reach);
  }
}

// Other ranks compute the forces on ghosts, and the pairs of two ghosts.
template <bool once, class Real>
TANDEM_HD bool is_listed(const View<Real>& view, std::uint32_t i, [[maybe_unused]] std::uint32_t j,
                         bool is_near) {
  if constexpr (once)
    return is_near && (view.spheres.owns(i) || view.spheres.owns(j));
  else
    return is_near && view.spheres.owns(i);
}

template <class Real, class Law, bool once, Levels levels>
struct CountPairs {
  View<Real> view;

  // A sphere so large that it searches very many cells, for which a group of threads is faster.
  TANDEM_HD bool looks_far(std::uint32_t i) const requires(levels == Levels::many) {
    constexpr typename LengthUnit<Real>::Count much_larger = 4;
    return view.spheres.position[view.window->progress[0].state_side ^ 1][i].radius / much_larger >
           view.grid.largest_of_finest;
  }
  template <class Group>
  TANDEM_HD void operator()(std::uint32_t i, const Group& group) const {
    std::uint32_t after = 0, before = 0;
    for_each_neighbour<Neighbours::all, Law, levels>(view, i, group,
                                                     [&](std::uint32_t j, Image, bool is_near) {
                                                       is_near = is_listed<once>(view, i, j, is_near);
                                                       after += group.count(is_near && j > i);
                                                       before += group.count(is_near && j < i);
                                                     });
    if (!group.first()) return;
    view.rebuild.count[i].pairs = once ? after : after + before;
    view.rebuild.count[i].mirrors = before;
  }
};

// Calls found(with, spring, list, k) for every contact that is carried over and owned by the sphere at old
// index i, whose label is `label`: entry k of the list. The sphere that comes first in RebuildArrays::order
// owns the contact of two spheres, whether or not pairs are evaluated once. Only contacts of the last micro
// step have a history; among the entries of a patch only the first can.
template <class Real, class Found>
TANDEM_HD void for_each_carried(const View<Real>& view, std::uint32_t i, const Label& label, Found found) {
  const std::uint32_t last = view.window->progress[0].stamp - 1;
  const IndexOrder order = view.rebuild.order;
  const PairList<Real>& pairs = view.lists.pairs;
  const WallList<Real>& walls = view.lists.walls;
  for (std::uint32_t k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
    const Neighbour other = fetch(pairs.entry + k);
    if (other.in_contact() && order.place(other.index()) > order.place(i))
      found(other.index(), pairs.spring[k], pairs, k);
  }
  const Range bodies = view.near_of(i, label);
  for (std::uint32_t b = bodies.begin; b < bodies.end; ++b) {
    const NearBody near = view.lists.near[b];
    for (std::uint32_t k = near.first; k < near.first + near.count; ++k) {
      const History<Real>& history = walls.history[k];
      if (history.stamp == last)
        found(wall_flag | view.surface.facets[walls.entry[k]].patch, history.spring, walls, k);
    }
  }
}

// Also counts the contacts that are carried over, which saves a GPU one kernel launch.
template <class Real, class Law>
struct CountWalls {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    std::uint32_t walls = 0, bodies = 0, last = view.surface.bodies;
    for_each_facet(view, i, [&](std::uint32_t body, std::uint32_t, double) {
      ++walls;
      if (body != last) ++bodies;
      last = body;
    });
    view.rebuild.count[i].walls = walls;
    view.rebuild.count[i].near = bodies;
    std::uint32_t carried = 0;
    if constexpr (Law::tangential)
      for_each_carried(view, i, view.spheres.velocity[view.window->progress[0].state_side][i].label,
                       [&](std::uint32_t, const Vec3<Real>&, const auto&, std::uint32_t) { ++carried; });
    view.rebuild.count[i].carried = carried;
  }
};

// Memory behind the lists' springs, in springs, for the contacts that do not fit into the state: one more
// than their number, because they have to be aligned.
template <class Real>
TANDEM_HD std::uint64_t springs_behind_lists(std::uint64_t carried, std::uint32_t n) {
  const std::uint64_t in_state = std::uint64_t{carried_in_state} * n;
  constexpr std::size_t size = sizeof(CarriedContact<Real>), of_spring = sizeof(Vec3<Real>);
  return carried > in_state ? ((carried - in_state + 1) * size + of_spring - 1) / of_spring : 0;
}

// Every later pass calls this, after the counts have been summed.
template <class Real>
TANDEM_HD bool lists_fit(const View<Real>& view) {
  const ListCounts& all = view.rebuild.count[view.spheres.count];
  const std::uint32_t listed = std::max(all.pairs, view.window->listed);
  return listed <= view.lists.pair_capacity &&
         listed + springs_behind_lists<Real>(all.carried, view.spheres.count) <= view.lists.spring_capacity &&
         all.walls <= view.lists.wall_capacity && all.near <= view.lists.near_capacity &&
         ((view.lists.pairs.rolling == nullptr && view.lists.walls.rolling == nullptr) ||
          all.carried <= view.rebuild.rolling_capacity);
}

// Memory of the saved contact c: in the side of the state that the spheres have left, or at the end of the
// springs, where neither the old lists nor the new ones reach.
template <class Real>
TANDEM_HD CarriedContact<Real>& carried_contact(const View<Real>& view, std::uint32_t c) {
  const std::uint32_t former = view.window->progress[0].state_side, n = view.spheres.count;
  static_assert(sizeof(PositionRadius<Real>) == sizeof(CarriedContact<Real>) &&
                sizeof(VelocityKind<Real>) == sizeof(CarriedContact<Real>) &&
                sizeof(Spin<Real>) == sizeof(CarriedContact<Real>));
  void* at = nullptr;
  if (c < n)
    at = view.spheres.position[former] + c;
  else if (c < 2 * n)
    at = view.spheres.velocity[former] + (c - n);
  else if (c < carried_in_state * n)
    at = view.spheres.spin[former] + (c - 2 * n);
  else {
    const auto end = reinterpret_cast<std::uintptr_t>(view.lists.pairs.spring + view.lists.spring_capacity);
    at = reinterpret_cast<CarriedContact<Real>*>(end - end % alignof(CarriedContact<Real>)) -
         (c - carried_in_state * n) - 1;
  }
  return *static_cast<CarriedContact<Real>*>(at);
}

// Saves the contacts of the sphere at new index i from the old lists, before these are overwritten. The
// label, moved with the sphere, still refers to the old list of bodies near it.
template <class Real>
struct Carry {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const std::uint32_t was = view.rebuild.source[i];
    std::uint32_t c = view.rebuild.count[was].carried;
    for_each_carried(view, was, view.spheres.velocity[view.window->progress[0].state_side ^ 1][i].label,
                     [&](std::uint32_t with, const Vec3<Real>& spring, const auto& list, std::uint32_t k) {
                       new (&carried_contact(view, c)) CarriedContact<Real>{with, spring};
                       if (list.rolling != nullptr) view.rebuild.carried_rolling[c] = list.rolling[k];
                       ++c;
                     });
  }
};

inline constexpr std::uint32_t not_carried = ~0u;
template <class Real>
TANDEM_HD std::uint32_t find_carried(const View<Real>& view, std::uint32_t old_index, std::uint32_t with) {
  for (std::uint32_t c = view.rebuild.count[old_index].carried; c < view.rebuild.count[old_index + 1].carried;
       ++c)
    if (carried_contact(view, c).with == with) return c;
  return not_carried;
}

// The spring that entry k of a new list inherits, and its rolling spring. reversed: the roles of the two
// spheres have been exchanged, so that relative quantities change their sign.
template <class Law, class List, class Real>
TANDEM_HD Vec3<Real> take_over(const View<Real>& view, const List& list, std::uint32_t k, std::uint32_t c,
                               bool reversed) {
  Vec3<Real> spring;
  if (c != not_carried) spring = carried_contact(view, c).spring;
  if (reversed) spring = -spring;
  if constexpr (Law::extended)
    if (list.rolling != nullptr) {
      RollingSpring<Real> rolling;
      if (c != not_carried) rolling = view.rebuild.carried_rolling[c];
      if (reversed) rolling.rolled = -rolling.rolled;  // twisting is about the normal, which is reversed, too
      list.rolling[k] = rolling;
    }
  return spring;
}

// Contacts of the last step keep their history. The history of spheres that have separated is dropped, except
// for laws whose contacts may last beyond touching.
template <class Real, class Law, bool once, Levels levels>
struct FillPairs {
  View<Real> view;

  TANDEM_HD bool fits() const { return lists_fit(view); }
  // Entries of the spheres at the successive indices first to last - 1.
  TANDEM_HD Range entries(std::uint32_t first, std::uint32_t last) const {
    return {view.rebuild.count[first].pairs, view.rebuild.count[last].pairs};
  }
  template <class Group>
  TANDEM_HD void operator()(std::uint32_t i, const Group& group) const {
    if (!fits()) return;
    find(i, group, [&](std::uint32_t k, std::uint32_t j, Image image, bool touching) {
      write(i, k, j, image, touching);
    });
  }
  // Calls put(k, j, image, touching) for each neighbour j of sphere i, which becomes entry k.
  template <class Group, class Put>
  TANDEM_HD void find(std::uint32_t i, const Group& group, Put put) const {
    const PositionRadius<Real>* position = view.spheres.position[view.window->progress[0].state_side ^ 1];
    const PositionRadius<Real> own = position[i];
    const ListCounts begin = view.rebuild.count[i], end = view.rebuild.count[i + 1];
    const std::uint32_t middle = once ? end.pairs : end.pairs - (end.mirrors - begin.mirrors);
    TwoEnds after{begin.pairs, middle}, before{middle, end.pairs};
    constexpr Neighbours side = once ? Neighbours::after : Neighbours::all;
    for_each_neighbour<side, Law, levels>(view, i, group, [&](std::uint32_t j, Image image, bool is_near) {
      is_near = is_listed<once>(view, i, j, is_near);
      const bool touching = is_near && may_touch<Law>(view.parameters, own, position[j], image);
      // Neighbours that touch now are adjacent in the middle of the list, so that most steps find a sphere's
      // contacts and their histories together.
      std::uint32_t k = after.take(group, is_near && j > i, !touching);
      if constexpr (!once) {
        const std::uint32_t other = before.take(group, is_near && j < i, touching);
        if (j < i) k = other;
      }
      if (is_near) put(k, j, image, touching);
    });
  }
  TANDEM_HD void write(std::uint32_t i, std::uint32_t k, std::uint32_t j, [[maybe_unused]] Image image,
                       [[maybe_unused]] bool touching) const {
    const PairList<Real>& pairs = view.lists.pairs;
    if constexpr (Law::extended)
      if (pairs.image != nullptr) pairs.image[k] = image;
    std::uint32_t carried = not_carried;
    if constexpr (Law::tangential) {
      const std::uint32_t was = view.rebuild.source[i], other = view.rebuild.source[j];
      const IndexOrder order = view.rebuild.order;
      const bool reversed = order.place(other) < order.place(was);
      if (Law::extended || touching)
        carried = find_carried(view, reversed ? other : was, reversed ? was : other);
      pairs.spring[k] = take_over<Law>(view, pairs, k, carried, reversed);
    }
    pairs.entry[k] = Neighbour::of(j, carried != not_carried);
  }
};

// Sets where the pairs of sphere i begin; i = n sets the end of the last.
template <bool once, class Real>
TANDEM_HD void set_starts(const View<Real>& view, std::uint32_t i) {
  const ListCounts below = view.rebuild.count[i];
  view.lists.pairs.start[i] = below.pairs;
  if (once) view.lists.mirror_start[i] = below.mirrors;
}

// Also sets where pairs begin, which no thread reads while they are filled; this saves a GPU one kernel
// launch. Runs for i = n, too.
template <class Real, class Law, bool once>
struct FillWalls {
  View<Real> view;

  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    set_starts<once>(view, i);
    if (i == view.spheres.count) return;
    const WallList<Real>& walls = view.lists.walls;
    std::uint32_t k = view.rebuild.count[i].walls;
    const std::uint32_t first_near = view.rebuild.count[i].near;
    view.spheres.velocity[view.window->progress[0].state_side ^ 1][i].label.set_near(
        first_near, view.rebuild.count[i + 1].near - first_near);
    NearBody* near = view.lists.near + first_near;
    std::uint32_t last = view.surface.bodies;
    for_each_facet(view, i, [&](std::uint32_t body, std::uint32_t facet, double slack) {
      if (body != last) *near++ = {i, body, k, 0};
      last = body;
      ++near[-1].count;
      walls.entry[k] = facet;
      view.lists.wall_slack[k] = static_cast<float>(slack);
      if constexpr (Law::tangential) {
        // The first entry of a patch holds the history of the patch. Every entry of the patch gets a copy;
        // only that of the first entry is read again, because steps do not use the others.
        const std::uint32_t carried =
            find_carried(view, view.rebuild.source[i], wall_flag | view.surface.facets[facet].patch);
        const Vec3<Real> spring = take_over<Law>(view, walls, k, carried, false);
        walls.history[k] = {spring, carried != not_carried ? view.window->progress[0].stamp - 1 : 0};
      }
      ++k;
    });
  }
};

// Lists the pairs in which each sphere is the other one.
template <class Real, class Law, Levels levels>
struct FillMirrors {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const PairList<Real>& pairs = view.lists.pairs;
    const PositionRadius<Real>* position = view.spheres.position[view.window->progress[0].state_side ^ 1];
    TwoEnds at{view.lists.mirror_start[i], view.lists.mirror_start[i + 1]};
    constexpr OneThread alone;
    for_each_neighbour<Neighbours::before, Law, levels>(
        view, i, alone, [&](std::uint32_t j, Image image, bool is_near) {
          if (!is_listed<true>(view, i, j, is_near)) return;
          std::uint32_t k = pairs.start[j];
          while (pairs.entry[k].index() != i) ++k;
          view.lists.mirror[at.take(alone, true,
                                    may_touch<Law>(view.parameters, position[i], position[j], image))] = k;
        });
  }
};

template <class Real>
struct FinishRebuild {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t) const {
    WindowProgress& c = *view.window;
    const ListCounts& all = view.rebuild.count[view.spheres.count];
    c.list_entries = all.pairs;
    c.wall_entries = all.walls;
    c.near_entries = all.near;
    c.carried_entries = all.carried;
    // Old state and lists are unchanged: the host allocates more memory, and the same rebuild is repeated.
    if (!lists_fit(view)) c.error |= list_overflow;
    if (c.error != 0) return;
    c.near = all.near;
    c.listed = all.pairs;
    c.used = view.rebuild.cell_start[first_parked_cell(view)];
    StepProgress& p = c.progress[0];
    p.state_side ^= 1;
    p.travel = p.wall_travel = 0;
    p.age = 0;
    p.rebuild_due = 0;
    c.max_speed2[0] = c.max_speed2[1] = p.max_speed2 = 0;
    ++c.rebuilds;
  }
};

}  // namespace tandem::dem
