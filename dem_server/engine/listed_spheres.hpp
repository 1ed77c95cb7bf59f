// The spheres of a state with their lists, sphere by sphere, in the order of one process. An EngineState has
// the same with indices, and with lists that refer to each other by where they begin. Here spheres are named
// by their ordinals (engine/rank_share.hpp) and lists have only lengths, so that the spheres of all ranks are
// those of each rank in turn, and a part of them is what remains without the others.
//
// All ranks together make the state of one process, and any number of ranks continues from it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "common/error.hpp"
#include "dem_server/contact/view.hpp"
#include "dem_server/engine/engine_state.hpp"
#include "dem_server/engine/rank_share.hpp"

namespace tandem::dem {

template <class Real>
struct ListedSpheres {
  struct Lengths {
    std::uint32_t pairs = 0, mirrors = 0, bodies = 0;
  };

  // Of each sphere. Labels say nothing of the bodies near it.
  std::vector<PositionRadius<Real>> position;
  std::vector<VelocityKind<Real>> velocity;
  std::vector<Spin<Real>> spin;
  std::vector<FinePart<Real>> fine;
  std::vector<std::uint32_t> id;
  std::vector<Lengths> lengths;
  // Of each pair. The index of a neighbour is the ordinal of the other sphere.
  std::vector<Neighbour> pair;
  std::vector<Vec3<Real>> spring;
  std::vector<RollingSpring<Real>> rolling;
  std::vector<Image> image;
  std::vector<std::uint32_t> mirror;  // ordinal of the sphere that has the pair
  // Of each body near a sphere, and of its facets near the sphere.
  std::vector<NearBody> near;  // without `sphere` and `first`
  std::vector<std::uint32_t> facet;
  std::vector<History<Real>> history;
  std::vector<RollingSpring<Real>> wall_rolling;
  std::vector<float> slack;

  std::uint32_t size() const { return static_cast<std::uint32_t>(position.size()); }

  // Replaces each array by f(array).
  template <class F>
  void transform(F f) {
    const auto each = [&f](auto&... array) { ((array = f(array)), ...); };
    each(position, velocity, spin, fine, id, lengths, pair, spring, rolling, image, mirror, near, facet,
         history, wall_rolling, slack);
  }

  // Without its lists.
  void append_sphere(const ListedSpheres& from, std::uint32_t i) {
    position.push_back(from.position[i]);
    velocity.push_back(from.velocity[i]);
    if (!from.spin.empty()) spin.push_back(from.spin[i]);
    if (!from.fine.empty()) fine.push_back(from.fine[i]);
    if (!from.id.empty()) id.push_back(from.id[i]);
    lengths.emplace_back();
  }
  void append_sphere(const SphereArrays<Real>& from, std::uint32_t side, std::uint32_t i,
                     const Needs& needs) {
    position.push_back(from.position[side][i]);
    velocity.push_back(from.velocity[side][i]);
    velocity.back().label = Label::of_kind(velocity.back().kind());
    if (needs.tangential)
      spin.push_back(from.spin[side][i]);
    else
      id.push_back(from.id[i]);
    if constexpr (has_fine_part<Real>) fine.push_back(from.fine[i]);
    lengths.emplace_back();
  }
};

// The spheres at the indices of a range. `ordinal`: of each index.
template <class Real>
ListedSpheres<Real> listed_spheres(const View<Real>& view, const Needs& needs, Range range,
                                   std::span<const std::uint32_t> ordinal) {
  ListedSpheres<Real> found;
  const ContactLists<Real>& lists = view.lists;
  const std::uint32_t side = view.window->progress[0].state_side;
  const bool are_lists = view.window->rebuilds > 0;
  std::vector<std::uint32_t> owner(are_lists ? view.window->listed : 0);  // of each pair
  for (std::uint32_t i = 0; are_lists && i < view.spheres.count; ++i) {
    const Range pairs = entries_of(lists.pairs.start, i);
    std::fill(owner.begin() + pairs.begin, owner.begin() + pairs.end, ordinal[i]);
  }
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    found.append_sphere(view.spheres, side, i, needs);
    if (!are_lists) continue;
    auto& lengths = found.lengths.back();
    const Range pairs = entries_of(lists.pairs.start, i);
    lengths.pairs = pairs.end - pairs.begin;
    for (std::uint32_t k = pairs.begin; k < pairs.end; ++k) {
      const Neighbour other = lists.pairs.entry[k];
      found.pair.push_back(Neighbour::of(ordinal[other.index()], other.in_contact()));
      if (needs.tangential) found.spring.push_back(lists.pairs.spring[k]);
      if (needs.rolling) found.rolling.push_back(lists.pairs.rolling[k]);
      if (needs.images) found.image.push_back(lists.pairs.image[k]);
    }
    if (needs.pairs_once) {
      const Range mirrors = entries_of(lists.mirror_start, i);
      lengths.mirrors = mirrors.end - mirrors.begin;
      for (std::uint32_t m = mirrors.begin; m < mirrors.end; ++m)
        found.mirror.push_back(owner[lists.mirror[m]]);
    }
    const Range bodies = view.near_of(i, view.spheres.velocity[side][i].label);
    lengths.bodies = bodies.end - bodies.begin;
    for (std::uint32_t b = bodies.begin; b < bodies.end; ++b) {
      const NearBody near = lists.near[b];
      found.near.push_back({0, near.body, 0, near.count});
      for (std::uint32_t k = near.first; k < near.first + near.count; ++k) {
        found.facet.push_back(lists.walls.entry[k]);
        if (needs.tangential) found.history.push_back(lists.walls.history[k]);
        if (needs.rolling) found.wall_rolling.push_back(lists.walls.rolling[k]);
        found.slack.push_back(lists.wall_slack[k]);
      }
    }
  }
  return found;
}

// The spheres of a rank with the ordinals of range `own`, with all pairs of these and their ghosts. `ordinal`
// receives the ordinals of all of them.
template <class Real>
ListedSpheres<Real> part_of(const ListedSpheres<Real>& whole, const Needs& needs, Range own,
                            std::vector<std::uint32_t>& ordinal) {
  const auto owns = [own](std::uint32_t i) { return i - own.begin < own.end - own.begin; };
  std::vector<bool> keeps(whole.size());
  std::uint32_t pair = 0;
  for (std::uint32_t i = 0; i < whole.size(); ++i) {
    if (owns(i)) keeps[i] = true;
    for (const std::uint32_t end = pair + whole.lengths[i].pairs; pair < end; ++pair) {
      const std::uint32_t j = whole.pair[pair].index();
      if (owns(i) != owns(j)) keeps[i] = keeps[j] = true;
    }
  }

  ListedSpheres<Real> part;
  ordinal.clear();
  std::uint32_t mirror = 0, body = 0, wall = 0;
  pair = 0;
  for (std::uint32_t i = 0; i < whole.size(); ++i) {
    const auto lengths = whole.lengths[i];
    const std::uint32_t pairs_end = pair + lengths.pairs, mirrors_end = mirror + lengths.mirrors,
                        bodies_end = body + lengths.bodies;
    std::uint32_t walls_end = wall;
    for (; body < bodies_end; ++body) {
      if (owns(i)) part.near.push_back(whole.near[body]);
      walls_end += whole.near[body].count;
    }
    if (keeps[i]) {
      ordinal.push_back(i);
      part.append_sphere(whole, i);
      auto& kept = part.lengths.back();
      for (std::uint32_t k = pair; k < pairs_end; ++k) {
        if (!owns(i) && !owns(whole.pair[k].index())) continue;
        ++kept.pairs;
        part.pair.push_back(whole.pair[k]);
        if (needs.tangential) part.spring.push_back(whole.spring[k]);
        if (needs.rolling) part.rolling.push_back(whole.rolling[k]);
        if (needs.images) part.image.push_back(whole.image[k]);
      }
      for (std::uint32_t m = mirror; m < mirrors_end; ++m)
        if (owns(i) || owns(whole.mirror[m])) {
          ++kept.mirrors;
          part.mirror.push_back(whole.mirror[m]);
        }
    }
    if (owns(i)) {
      part.lengths.back().bodies = lengths.bodies;
      const auto take = [&](const auto& all, auto& kept) {
        kept.insert(kept.end(), all.begin() + wall, all.begin() + walls_end);
      };
      take(whole.facet, part.facet), take(whole.slack, part.slack);
      if (needs.tangential) take(whole.history, part.history);
      if (needs.rolling) take(whole.wall_rolling, part.wall_rolling);
    }
    pair = pairs_end, mirror = mirrors_end, wall = walls_end;
  }
  return part;
}

// Stores spheres with these ordinals, which ascend, as a state. `fewest`: indices that it has at least; those
// without a sphere are parked. The progress of the window is left as it is, but for the lengths of lists.
template <class Exec, class Real>
void store_spheres(Exec& exec, const Needs& needs, const ListedSpheres<Real>& spheres,
                   std::span<const std::uint32_t> ordinal, std::uint32_t fewest,
                   EngineState<Exec, Real>& state) {
  const std::uint32_t count = spheres.size(), n = std::max(count, fewest);
  const auto index_of = [&](std::uint32_t wanted) {
    return static_cast<std::uint32_t>(std::lower_bound(ordinal.begin(), ordinal.end(), wanted) -
                                      ordinal.begin());
  };
  state.spheres = {};
  state.lists = {};
  state.spheres.grow(exec, n, needs);
  state.lists.grow_spheres(exec, n, needs);
  state.lists.grow_pairs(exec, spheres.pair.size() + Exec::read_ahead, needs);
  state.lists.grow_springs(exec, spheres.pair.size(), needs);
  state.lists.grow_walls(exec, spheres.facet.size(), needs);
  exec.grow(state.lists.near, spheres.near.size());
  const SphereArrays<Real> to = state.spheres.view(n);
  const ContactLists<Real> lists = state.lists.view(needs);
  const auto copy = [](const auto& from, auto* into) {
    if (into != nullptr) std::copy(from.begin(), from.end(), into);
  };
  for (const int side : {0, 1}) {
    copy(spheres.position, to.position[side]), copy(spheres.velocity, to.velocity[side]);
    copy(spheres.spin, to.spin[side]);
    for (std::uint32_t i = count; i < n; ++i) to.position[side][i].radius = parked_radius<Real>;
  }
  copy(spheres.fine, to.fine), copy(spheres.id, to.id);
  copy(spheres.spring, lists.pairs.spring), copy(spheres.rolling, lists.pairs.rolling);
  copy(spheres.image, lists.pairs.image);
  copy(spheres.facet, lists.walls.entry), copy(spheres.history, lists.walls.history);
  copy(spheres.wall_rolling, lists.walls.rolling), copy(spheres.slack, lists.wall_slack);

  std::uint32_t pair = 0, body = 0, wall = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    lists.pairs.start[i] = pair;
    if (i >= count) continue;
    for (const std::uint32_t end = pair + spheres.lengths[i].pairs; pair < end; ++pair) {
      const Neighbour other = spheres.pair[pair];
      lists.pairs.entry[pair] = Neighbour::of(index_of(other.index()), other.in_contact());
    }
    for (const int side : {0, 1}) to.velocity[side][i].label.set_near(body, spheres.lengths[i].bodies);
    for (const std::uint32_t end = body + spheres.lengths[i].bodies; body < end; ++body) {
      lists.near[body] = {i, spheres.near[body].body, wall, spheres.near[body].count};
      wall += spheres.near[body].count;
    }
  }
  lists.pairs.start[n] = pair;
  if (needs.pairs_once) {
    std::uint32_t mirror = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      lists.mirror_start[i] = mirror;
      if (i >= count) continue;
      for (const std::uint32_t end = mirror + spheres.lengths[i].mirrors; mirror < end; ++mirror) {
        const std::uint32_t owner = index_of(spheres.mirror[mirror]);
        std::uint32_t k = lists.pairs.start[owner];
        while (k < pair && lists.pairs.entry[k].index() != i) ++k;
        if (k == pair)
          throw Error(ErrorCode::internal, "a pair is listed by one of its spheres only", "ranks");
        lists.mirror[mirror] = k;
      }
    }
    lists.mirror_start[n] = mirror;
  }
  WindowProgress& window = state.host_window;
  window.indices = n;
  window.listed = pair, window.list_entries = pair;
  window.near = window.near_entries = body;
  window.wall_entries = wall;
  window.carried_entries = 0;
  window.error = window.step_error[0] = window.step_error[1] = 0;
  window.culprit = ~0u;
  state.window.resize(1);
  *state.window.data() = window;
}

}  // namespace tandem::dem
