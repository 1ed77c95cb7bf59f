// The engine's members for memory: how large its arrays are, and where a View finds them.
#pragma once

#include <algorithm>
#include <limits>
#include <string>

#include "common/error.hpp"
#include "dem_server/engine/engine_of.hpp"

namespace tandem::dem {

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::make_room_for(std::uint32_t steps) {
  const std::size_t rows = std::size_t{steps} * (slots_ + 1);
  if (load_.size() >= rows * 6) return;
  load_.resize(rows * 6);
  pose_.resize(std::size_t{steps} * slots_);
  paths_.resize(slots_);
}

// Lists keep their lengths. What is in new slots is for the caller to say.
template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::make_slots(std::uint32_t n) {
  n_ = now_.host_control.slots = n;
  for (int side = 0; side < 2; ++side) {
    exec_.grow(now_.place[side], n_);
    exec_.grow(now_.drift[side], n_);
    if constexpr (Law::tangential) exec_.grow(now_.spin[side], n_);
  }
  if constexpr (has_remainder<Real>) exec_.grow(now_.remainder, n_);
  if constexpr (!Law::tangential) exec_.grow(now_.id, n_);
  exec_.grow(now_.pairs.start, n_ + 1);
  if constexpr (once) exec_.grow(now_.mirror_start, n_ + 1);
  exec_.grow(source_, n_);
  exec_.grow(count_, n_ + 1);
  exec_.grow(cell_start_, cells() + 2);
  if (!size_levels_.coarse.empty()) {
    exec_.grow(coarse_start_, coarse_cells() + 2);
    exec_.grow(coarse_slot_, n_);
  }
  grow_pairs(0);
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::make_room_to_come_in(std::uint32_t count) {
  const std::uint32_t before = n_, wanted = now_.host_control.used + count;
  if (wanted <= before) return;
  make_slots(room_for(wanted));
  refresh_view();
  exec_.for_each(n_ - before, EmptySlots<Real>{view_, before});
}

// Where most spheres have gone, so that nobody looks at their slots any more. Their memory is kept.
template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::leave_empty_slots() {
  const std::uint32_t enough = room_for(now_.host_control.used);
  if (n_ / 2 <= enough) return;
  make_slots(enough);
  refresh_view();
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::grow_pairs(std::size_t entries) {
  entries += Exec::read_ahead;
  exec_.grow(now_.pairs.entry, entries);
  if (has_turns()) exec_.grow(now_.pairs.turn, entries);
  if constexpr (Law::extended)
    if (view_.parameters.periods.any()) exec_.grow(now_.pairs.image, entries);
  if constexpr (!once) return;
  exec_.grow(now_.mirror, entries);
  close_pair_.resize(now_.mirror.size());
  for (auto* buffer : {&close_number_, &close_mirror_}) buffer->resize(now_.mirror.size());
  for (auto* buffer : {&close_owned_, &close_mirrored_}) buffer->resize(n_);
  pair_force_.resize(now_.mirror.size());
  if constexpr (Law::tangential) pair_couple_.resize(now_.mirror.size());
  if constexpr (Law::extended) pair_moment_.resize(now_.pairs.turn.size());
}

// For the pairs' entries, and what is carried over behind them.
template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::grow_springs(std::size_t entries) {
  if constexpr (Law::tangential) exec_.grow(now_.pairs.spring, entries);
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::grow_walls(std::size_t entries) {
  exec_.grow(now_.walls.entry, entries);
  if constexpr (Law::tangential) exec_.grow(now_.walls.history, entries);
  if (has_turns()) exec_.grow(now_.walls.turn, entries);
  exec_.grow(now_.wall_slack, entries);
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::grow_near(std::size_t pairs) {
  exec_.grow(now_.near, pairs);
  wall_force_.resize(now_.near.size());
  if (has_bodies()) tangents_.resize(now_.near.size());
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::grow_turns(std::size_t contacts) {
  if (has_turns()) carried_turn_.resize(contacts);
}

// A rebuild found more than there is room for, and left state and lists as they were.
template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::enlarge_lists(const Control& wanted) {
  if (wanted.near_entries > Label::most_near)
    throw Error(ErrorCode::resource,
                std::to_string(wanted.near_entries) + " times a sphere is near a body's walls; " +
                    std::to_string(Label::most_near) + " can be told apart",
                "dem", "use fewer spheres");
  // To spare: a part of the entries, of many a sixteenth of that, since it is then memory that counts. While
  // spheres come in, lists grow with them.
  const bool coming = n_ < radius_.size();
  const auto with_spare = [coming](std::size_t entries, std::size_t part, std::size_t few) {
    return entries + (coming ? entries / 4 : std::max(entries / (16 * part), std::min(entries / part, few)));
  };
  const std::uint64_t pairs = std::max<std::uint64_t>(wanted.list_entries, wanted.listed),
                      springs = pairs + springs_behind_lists<Real>(wanted.carried_entries, n_);
  if (pairs > view_.pair_capacity) grow_pairs(with_spare(pairs, 64, 1u << 16));
  if (springs > view_.spring_capacity) grow_springs(with_spare(springs, 64, 1u << 16));
  if (wanted.wall_entries > view_.wall_capacity) grow_walls(with_spare(wanted.wall_entries, 4, 1u << 12));
  if (wanted.near_entries > view_.near_capacity) grow_near(with_spare(wanted.near_entries, 4, 1u << 12));
  if (wanted.carried_entries > view_.turn_capacity)
    grow_turns(wanted.carried_entries + wanted.carried_entries / 8);
  refresh_view();
  // Else the same rebuild would be done again for ever.
  if (pairs > view_.pair_capacity || springs > view_.spring_capacity ||
      wanted.wall_entries > view_.wall_capacity || wanted.near_entries > view_.near_capacity ||
      (has_turns() && wanted.carried_entries > view_.turn_capacity))
    throw Error(ErrorCode::internal, "lists do not fit into the room that was made for them", "rebuild");
}

template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::refresh_view() {
  view_.n = n_;
  view_.control = now_.control.data();
  for (int side = 0; side < 2; ++side) {
    view_.place[side] = now_.place[side].data();
    view_.drift[side] = now_.drift[side].data();
    view_.spin[side] = now_.spin[side].data();
  }
  view_.remainder = now_.remainder.data();
  view_.id = now_.id.data();
  const auto or_none = [](auto& buffer) { return buffer.size() > 0 ? buffer.data() : nullptr; };
  view_.pairs = {now_.pairs.start.data(), now_.pairs.entry.data(), now_.pairs.spring.data(),
                 or_none(now_.pairs.turn), or_none(now_.pairs.image)};
  view_.walls = {now_.walls.entry.data(), now_.walls.history.data(), or_none(now_.walls.turn)};
  view_.pair_capacity = static_cast<std::uint32_t>(now_.pairs.entry.size() - Exec::read_ahead);
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
  view_.spring_capacity =
      static_cast<std::uint32_t>(Law::tangential ? std::min(now_.pairs.spring.size(), most) : most);
  view_.mirror_start = now_.mirror_start.data();
  view_.mirror = now_.mirror.data();
  view_.close = {close_pair_.data(),     close_number_.data(), close_owned_.data(), close_mirror_.data(),
                 close_mirrored_.data(), pair_force_.data(),   pair_couple_.data(), or_none(pair_moment_)};
  view_.wall_slack = now_.wall_slack.data();
  view_.near = now_.near.data();
  view_.wall_force = wall_force_.data();
  view_.near_capacity =
      std::min<std::uint32_t>(static_cast<std::uint32_t>(now_.near.size()), Label::most_near);
  view_.wall_capacity = static_cast<std::uint32_t>(now_.walls.entry.size());
  view_.source = source_.data();
  view_.cell_start = cell_start_.data();
  std::copy(std::begin(size_levels_.finest), std::end(size_levels_.finest), view_.grid);
  view_.levels = 1 + static_cast<std::uint32_t>(size_levels_.coarse.size());
  view_.largest_of_finest = view_.parameters.unit.count(size_levels_.largest_of_finest);
  view_.coarse = coarse_.data();
  view_.coarse_start = coarse_start_.data();
  view_.coarse_slot = coarse_slot_.data();
  view_.count = count_.data();
  view_.carried_turn = or_none(carried_turn_);
  view_.turn_capacity = static_cast<std::uint32_t>(carried_turn_.size());
  view_.extras = extras_.data();
  view_.slots = slots_;
  view_.facets = facets_.data();
  view_.patches = patches_.data();
  view_.facet_grids = facet_grids_.data();
  view_.facet_cell_start = facet_cell_start_.data();
  view_.facet_cell_entry = facet_cell_entry_.data();
  view_.pose = pose_.data();
  view_.load = load_.data();
  view_.books = books_.data();
  exec_.forget_captured();
}

template <class Exec, class Law, class Real>
std::size_t EngineOf<Exec, Law, Real>::memory_bytes() const {
  std::size_t sum = 0;
  const auto add = [&sum](const auto& buffer) { sum += buffer.size() * sizeof(*buffer.data()); };
  for (const State* state : {&now_, &saved_})
    for_each_buffer([&](const std::string&, const auto& buffer) { add(buffer); }, *state);
  for (const auto* b :
       {&source_, &cell_start_, &coarse_start_, &coarse_slot_, &facet_cell_start_, &facet_cell_entry_})
    add(*b);
  add(count_);
  add(carried_turn_);
  for (const auto* b : {&tangents_, &tangent_runs_, &tangent_sums_}) add(*b);
  add(facets_);
  add(pose_);
  add(load_);
  add(wall_force_);
  add(close_pair_);
  add(close_number_);
  add(close_mirror_);
  add(close_owned_);
  add(close_mirrored_);
  add(pair_force_);
  add(pair_couple_);
  add(pair_moment_);
  // What the host is told of the loads: their sums, and what they come to.
  if constexpr (Exec::on_host)
    sum += load_.size() * sizeof(load_fixed_[0]) + pose_.size() * sizeof(outcome_.load[0]);
  return sum;
}

}  // namespace tandem::dem
