// The engine's members for ranks (engine/rank_share.hpp). A rebuild of the lists begins with
//
//   redistribute: cells of the ranks from the numbers of spheres -> each sphere and its contacts to the rank
//                 that will move it, and to those that will have it as a ghost
//
// so that the rebuild finds arrays and old lists as though this rank had always had these spheres. It ends
// with connect_ghosts. Each step then ends with
//
//   send_ghosts: the new state of the spheres that others have as ghosts
//   combine_step: the largest speed and the errors of all ranks, on which the next rebuild depends
//   receive_ghosts
//
// These need the arrays in the memory of the host. A back end on a GPU will have kernels that pack and unpack
// them; the order of all else is the same.
#pragma once

#include <algorithm>
#include <bit>
#include <variant>
#include <vector>

#include "dem_server/engine/engine_of.hpp"
#include "dem_server/engine/travelling.hpp"

namespace tandem::dem {

// Work of sphere i in a step, in halves of that of a pair. A sphere takes as long as a pair in its list, some
// 30 ns [docs/experiments/2026-11-ranks.md]. A time that is measured in the run would give other shares,
// though the same bits, each time.
template <BackEnd Exec, class Law, class Real>
std::int64_t EngineOf<Exec, Law, Real>::work_of(std::uint32_t i) const {
  const ContactLists<Real>& lists = view_.lists;
  const Range pairs = entries_of(lists.pairs.start, i), mirrors = entries_of(lists.mirror_start, i);
  return std::int64_t{2} + (pairs.end - pairs.begin) + (mirrors.end - mirrors.begin);
}

template <BackEnd Exec, class Law, class Real>
CellShares EngineOf<Exec, Law, Real>::balanced_shares() const {
  const FindCell<Real> cell_of{view_};
  const std::uint32_t side = view_.window->progress[0].state_side;
  constexpr std::uint32_t per_block = CellShares::cells_per_block;
  std::vector<std::int64_t> work((view_.cells().total + per_block - 1) / per_block);
  for (std::uint32_t i = share_.owned.begin; i < share_.owned.end; ++i)
    if (!is_parked(view_.spheres.position[side][i])) work[cell_of(i) / per_block] += work_of(i);
  ranks_->sum(work);
  return {work, ranks_->weights()};
}

// Calls f(rank) for each rank that moves sphere i or may have a neighbour of it.
template <BackEnd Exec, class Law, class Real>
template <class F>
void EngineOf<Exec, Law, Real>::for_each_rank_near(std::uint32_t i, F f) const {
  const std::uint32_t side = view_.window->progress[0].state_side;
  const CellGrid& grid = view_.cells();
  const auto& unit = view_.parameters.unit;
  Vec3<std::int32_t> within{1, 1, 1};
  if (view_.grid.levels > 1) {
    // A sphere searches the cells of the finest level that it reaches; the largest one may find it from
    // there.
    const double reach = unit.exact_metres(view_.spheres.position[side][i].radius) + largest_radius_ +
                         unit.exact_metres(unit.count(view_.window->skin) + view_.parameters.range);
    for (int axis = 0; axis < 3; ++axis) within[axis] = cells_within(grid, axis, (1 + 1e-6) * reach);
  }
  cell_shares_.for_each_around(grid, view_.position_in_domain(view_.centre(side, i)), within, f);
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::redistribute() {
  cell_shares_ = balanced_shares();
  std::vector<Ranks::Bytes> to(ranks_->size());
  const FindCell<Real> cell_of{view_};
  const std::uint32_t side = view_.window->progress[0].state_side;
  for (std::uint32_t i = share_.owned.begin; i < share_.owned.end; ++i) {
    if (is_parked(view_.spheres.position[side][i])) continue;
    const unsigned owner = cell_shares_.owner(cell_of(i));
    for_each_rank_near(i, [&](unsigned rank) { pack_sphere(i, rank == owner, to[rank]); });
  }
  unpack_spheres(ranks_->exchange(to));
}

// Appends sphere i and its contacts with spheres; those with walls only for the rank that will move it.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::pack_sphere(std::uint32_t i, bool with_walls, Ranks::Bytes& bytes) const {
  const SphereArrays<Real>& spheres = view_.spheres;
  const ContactLists<Real>& lists = view_.lists;
  const std::uint32_t side = view_.window->progress[0].state_side;
  TravellingSphere<Real> sphere;
  sphere.position = spheres.position[side][i];
  sphere.velocity = spheres.velocity[side][i];
  if constexpr (Law::tangential) sphere.spin = spheres.spin[side][i];
  sphere.fine = spheres.fine_part(i);
  sphere.id = Law::tangential ? sphere.spin.id : spheres.id[i];
  sphere.ordinal = share_.ordinal[i];
  const std::size_t at = bytes.size();
  put(bytes, sphere);
  if constexpr (Law::tangential) {
    const auto rolling = [](const auto& list, std::uint32_t k) {
      return list.rolling != nullptr ? list.rolling[k] : RollingSpring<Real>{};
    };
    for_each_carried(
        view_, i, sphere.velocity.label,
        [&](std::uint32_t with, const Vec3<Real>& spring, const auto&, std::uint32_t k) {
          if ((with & wall_flag) != 0) return;
          put(bytes, TravellingContact<Real>{share_.ordinal[with], spring, rolling(lists.pairs, k)});
          ++sphere.contacts;
        });
    const std::uint32_t last = view_.window->progress[0].stamp - 1;
    const Range bodies = with_walls ? view_.near_of(i, sphere.velocity.label) : Range{};
    for (std::uint32_t b = bodies.begin; b < bodies.end; ++b) {
      const NearBody near = lists.near[b];
      for (std::uint32_t k = near.first; k < near.first + near.count; ++k) {
        const History<Real>& history = lists.walls.history[k];
        if (history.stamp != last) continue;
        put(bytes, TravellingWall<Real>{near.body, lists.walls.entry[k], history, rolling(lists.walls, k)});
        ++sphere.walls;
      }
    }
  }
  std::memcpy(bytes.data() + at, &sphere, sizeof sphere);  // now with the numbers of its contacts
}

// Replaces the spheres of this rank, and its lists by the contacts that came with them. Each rank sends in
// the order of ordinals, and lower ranks have lower ordinals.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::unpack_spheres(const std::vector<Ranks::Bytes>& from) {
  struct Known {
    std::uint32_t owner;
    TravellingContact<Real> contact;
  };
  std::vector<TravellingSphere<Real>> spheres;
  std::vector<Known> contacts;
  std::vector<TravellingWall<Real>> walls;
  for (const Ranks::Bytes& bytes : from)
    for (const std::byte *at = bytes.data(), *const end = at + bytes.size(); at != end;) {
      const auto sphere = take<TravellingSphere<Real>>(at);
      for (std::uint32_t k = 0; k < sphere.contacts; ++k)
        contacts.push_back({static_cast<std::uint32_t>(spheres.size()), take<TravellingContact<Real>>(at)});
      for (std::uint32_t k = 0; k < sphere.walls; ++k) walls.push_back(take<TravellingWall<Real>>(at));
      spheres.push_back(sphere);
    }
  share_.ordinal.clear();
  for (const TravellingSphere<Real>& sphere : spheres) share_.ordinal.push_back(sphere.ordinal);

  const auto n = static_cast<std::uint32_t>(spheres.size());
  memory_.resize_spheres(exec_, n);
  memory_.grow_pairs(exec_, contacts.size());
  memory_.now.lists.grow_springs(exec_, contacts.size(), memory_.needs);
  memory_.now.lists.grow_walls(exec_, walls.size(), memory_.needs);
  memory_.grow_near(exec_, walls.size());
  refresh_view();
  WindowProgress& window = *view_.window;
  window.indices = n;
  const std::uint32_t side = window.progress[0].state_side;
  const ContactLists<Real>& lists = view_.lists;
  std::uint32_t k = 0, contact = 0, wall = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const TravellingSphere<Real>& sphere = spheres[i];
    view_.spheres.position[side][i] = sphere.position;
    VelocityKind<Real>& velocity = view_.spheres.velocity[side][i] = sphere.velocity;
    velocity.label = Label::of_kind(sphere.velocity.kind());
    if constexpr (Law::tangential)
      view_.spheres.spin[side][i] = sphere.spin;
    else
      view_.spheres.id[i] = sphere.id;
    if constexpr (has_fine_part<Real>) view_.spheres.fine[i] = sphere.fine;

    lists.pairs.start[i] = k;
    for (; contact < contacts.size() && contacts[contact].owner == i; ++contact) {
      const TravellingContact<Real>& c = contacts[contact].contact;
      const auto other = std::lower_bound(share_.ordinal.begin(), share_.ordinal.end(), c.with);
      if (other == share_.ordinal.end() || *other != c.with) continue;  // neither sphere of it is moved here
      lists.pairs.entry[k] = Neighbour::of(static_cast<std::uint32_t>(other - share_.ordinal.begin()), true);
      lists.pairs.spring[k] = c.spring;
      if (lists.pairs.rolling != nullptr) lists.pairs.rolling[k] = c.rolling;
      ++k;
    }
    velocity.label.set_near(wall, sphere.walls);
    for (const std::uint32_t end = wall + sphere.walls; wall < end; ++wall) {
      lists.near[wall] = {i, walls[wall].body, wall, 1};
      lists.walls.entry[wall] = walls[wall].facet;
      lists.walls.history[wall] = walls[wall].history;
      if (lists.walls.rolling != nullptr) lists.walls.rolling[wall] = walls[wall].rolling;
    }
  }
  lists.pairs.start[n] = window.listed = k;
  window.near = wall;
}

// To be called when the spheres have been sorted into cells.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::find_own_and_ghosts() {
  const auto indices_of = [&](unsigned rank) {
    const Range cells = cell_shares_.of(rank);
    return Range{view_.rebuild.cell_start[cells.begin], view_.rebuild.cell_start[cells.end]};
  };
  share_.owned = view_.spheres.owned = indices_of(ranks_->rank());
  share_.links.clear();
  for (unsigned rank = 0; rank < ranks_->size(); ++rank)
    if (rank != ranks_->rank()) share_.links.push_back({rank, {}, indices_of(rank)});
}

// To be called when the lists are built.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::connect_ghosts() {
  std::vector<std::int64_t> spheres(ranks_->size()), work(ranks_->size());
  spheres[ranks_->rank()] = share_.owned.end - share_.owned.begin;
  for (std::uint32_t i = share_.owned.begin; i < share_.owned.end; ++i) work[ranks_->rank()] += work_of(i);
  ranks_->sum(spheres);
  ranks_->sum(work);
  const double mean = std::accumulate(work.begin(), work.end(), 0.0) / ranks_->size();
  rank_imbalance_ = mean > 0 ? static_cast<double>(std::ranges::max(work)) / mean : 1;
  const auto lower = spheres.begin() + ranks_->rank();
  const auto first = static_cast<std::uint32_t>(std::accumulate(spheres.begin(), lower, std::int64_t{0}));
  share_.all = static_cast<std::uint32_t>(std::accumulate(lower, spheres.end(), std::int64_t{first}));

  std::vector<std::uint32_t> link_of(ranks_->size());
  for (std::size_t k = 0; k < share_.links.size(); ++k)
    link_of[share_.links[k].rank] = static_cast<std::uint32_t>(k);
  share_.ordinal.assign(memory_.n, 0);
  for (std::uint32_t i = share_.owned.begin; i < share_.owned.end; ++i) {
    share_.ordinal[i] = first + (i - share_.owned.begin);
    for_each_rank_near(i, [&](unsigned rank) {
      if (rank != ranks_->rank()) share_.links[link_of[rank]].send.push_back(i);
    });
  }
  std::erase_if(share_.links, [](const GhostLink& link) {
    return link.send.empty() && link.ghosts.begin == link.ghosts.end;
  });
  send_to_neighbours<std::uint32_t>([&](std::uint32_t i) { return share_.ordinal[i]; });
  receive_from_neighbours<std::uint32_t>(
      [&](std::uint32_t i, std::uint32_t value) { share_.ordinal[i] = value; });
}

// Sends get(i) of each own sphere that others have as a ghost.
template <BackEnd Exec, class Law, class Real>
template <class T, class Get>
void EngineOf<Exec, Law, Real>::send_to_neighbours(Get get) {
  std::vector<Ranks::Parcel> to, from;
  parcels_.resize(std::max(parcels_.size(), 2 * share_.links.size()));
  for (std::size_t l = 0; l < share_.links.size(); ++l) {
    const GhostLink& link = share_.links[l];
    Ranks::Bytes &out = parcels_[2 * l], &in = parcels_[2 * l + 1];
    out.resize(link.send.size() * sizeof(T));
    in.resize((link.ghosts.end - link.ghosts.begin) * sizeof(T));
    std::byte* at = out.data();
    for (const std::uint32_t i : link.send) {
      const T value = get(i);
      std::memcpy(at, &value, sizeof value);
      at += sizeof value;
    }
    if (!out.empty()) to.push_back({link.rank, out});
    if (!in.empty()) from.push_back({link.rank, in});
  }
  ranks_->begin_swap(to, from);
}

// Waits for what the others have sent in the same call, and calls set(i, value) for each ghost.
template <BackEnd Exec, class Law, class Real>
template <class T, class Set>
void EngineOf<Exec, Law, Real>::receive_from_neighbours(Set set) {
  ranks_->end_swap();
  for (std::size_t l = 0; l < share_.links.size(); ++l) {
    const std::byte* at = parcels_[2 * l + 1].data();
    const Range ghosts = share_.links[l].ghosts;
    for (std::uint32_t i = ghosts.begin; i < ghosts.end; ++i) set(i, take<T>(at));
  }
}

// Spheres that come in follow all others in order. The last rank has no ghosts behind its own spheres, so
// that it takes them; the next rebuild gives them to the ranks in whose cells they are. Returns the first
// index.
template <BackEnd Exec, class Law, class Real>
std::uint32_t EngineOf<Exec, Law, Real>::make_room_on_last_rank(std::uint32_t count) {
  const std::uint32_t first = share_.owned.end, ordinal = share_.all;
  share_.all += count;
  if (ranks_->rank() + 1 < ranks_->size()) return first;
  share_.owned.end += count;
  share_.ordinal.resize(share_.owned.end);
  std::iota(share_.ordinal.begin() + first, share_.ordinal.end(), ordinal);
  if (share_.owned.end > memory_.n) enlarge_spheres(share_.owned.end);
  refresh_view();
  return first;
}

// What a neighbour reads of a sphere in a step. The label of a ghost refers to no walls.
template <class Real, bool with_spin>
struct GhostState {
  PositionRadius<Real> position;
  VelocityKind<Real> velocity;
  [[no_unique_address]] std::conditional_t<with_spin, Spin<Real>, std::monostate> spin;
};

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::send_ghosts(std::uint32_t side) {
  const SphereArrays<Real>& s = view_.spheres;
  send_to_neighbours<GhostState<Real, Law::tangential>>([&](std::uint32_t i) {
    GhostState<Real, Law::tangential> ghost;
    ghost.position = s.position[side][i];
    ghost.velocity = s.velocity[side][i];
    ghost.velocity.label = Label::of_kind(ghost.velocity.kind());
    if constexpr (Law::tangential) ghost.spin = s.spin[side][i];
    return ghost;
  });
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::receive_ghosts(std::uint32_t side) {
  const SphereArrays<Real>& s = view_.spheres;
  receive_from_neighbours<GhostState<Real, Law::tangential>>([&](std::uint32_t i, const auto& ghost) {
    s.position[side][i] = ghost.position;
    s.velocity[side][i] = ghost.velocity;
    if constexpr (Law::tangential) s.spin[side][i] = ghost.spin;
  });
}

// To be called when the own spheres have moved.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::finish_step() {
  if constexpr (Exec::on_host) {
    if (ranks_ == nullptr) return;
    const std::uint32_t side = view_.window->progress[0].state_side ^ 1;
    send_ghosts(side);
    combine_step();  // while the messages are under way
    receive_ghosts(side);
  }
}

// Combines what a step has reported to the progress of the window.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::combine_step() {
  WindowProgress& window = *view_.window;
  std::uint64_t most[] = {std::bit_cast<std::uint32_t>(window.max_speed2[0]), ~window.culprit, window.error};
  ranks_->maximum(most);
  window.max_speed2[0] = std::bit_cast<float>(static_cast<std::uint32_t>(most[0]));
  window.culprit = ~static_cast<std::uint32_t>(most[1]);
  if (most[2] != 0) window.error = any_of_ranks(window.error);
}

// Bits that are set on any rank.
template <BackEnd Exec, class Law, class Real>
std::uint32_t EngineOf<Exec, Law, Real>::any_of_ranks(std::uint32_t bits) {
  std::uint64_t each[32];
  for (unsigned k = 0; k < 32; ++k) each[k] = bits >> k & 1;
  ranks_->maximum(each);
  std::uint32_t any = 0;
  for (unsigned k = 0; k < 32; ++k) any |= static_cast<std::uint32_t>(each[k]) << k;
  return any;
}

// Combines what a window has summed: in `window`, in total_sums_, and in load_fixed_. `lost`: number of
// spheres lost before the window.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::combine_window(WindowProgress& window, std::uint64_t lost) {
  ranks_->sum(total_sums_);
  ranks_->sum(std::span(load_fixed_).first(std::size_t{window.steps} * (memory_.bodies + 1) * 6));
  std::int64_t newly_lost[] = {static_cast<std::int64_t>(window.lost - lost)};
  ranks_->sum(newly_lost);
  window.lost = lost + static_cast<std::uint64_t>(newly_lost[0]);
  std::uint64_t deepest[] = {std::bit_cast<std::uint32_t>(window.max_overlap_ratio)};
  ranks_->maximum(deepest);
  window.max_overlap_ratio = std::bit_cast<float>(static_cast<std::uint32_t>(deepest[0]));
  window.used = share_.all;
}

// Replaces the values of all indices here by those of the own spheres of all ranks on rank 0, and by none on
// the others.
template <BackEnd Exec, class Law, class Real>
template <class T>
void EngineOf<Exec, Law, Real>::gather_at_first(std::vector<T>& of_index) const {
  const std::span<const T> all(of_index);
  of_index = gathered(all.subspan(share_.owned.begin, share_.owned.end - share_.owned.begin), false);
}

// The values of all ranks in the order of ranks, on all of them or on rank 0 only.
template <BackEnd Exec, class Law, class Real>
template <class T>
std::vector<T> EngineOf<Exec, Law, Real>::gathered(std::span<const T> own, bool on_all) const {
  std::vector<Ranks::Bytes> to(ranks_->size());
  const auto bytes = std::as_bytes(own);
  for (unsigned rank = 0; rank < (on_all ? ranks_->size() : 1); ++rank)
    to[rank].assign(bytes.begin(), bytes.end());
  std::vector<T> all;
  for (const Ranks::Bytes& part : ranks_->exchange(to)) {
    const std::size_t before = all.size();
    all.resize(before + part.size() / sizeof(T));
    if (!part.empty()) std::memcpy(all.data() + before, part.data(), part.size());
  }
  return all;
}

}  // namespace tandem::dem
