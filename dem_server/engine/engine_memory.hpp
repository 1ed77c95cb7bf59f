// All arrays of an engine, their lengths, and the View of them. It needs no functor, so that CountExec can
// count the bytes of an engine without building one.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "dem_server/engine/account.hpp"
#include "dem_server/engine/engine_state.hpp"
#include "dem_server/engine/interface_stiffness.hpp"
#include "dem_server/engine/rank_buffers.hpp"
#include "dem_server/engine/wall_rows.hpp"
#include "dem_server/neighbours/build.hpp"

namespace tandem::dem {

template <class Exec, class Law, class Real>
struct EngineMemory {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;
  using State = EngineState<Exec, Real>;

  Needs needs;
  SizeLevels size_levels;
  std::uint32_t bodies = 0;  // with walls, including the ground
  bool belts = false;        // some of them are belts
  bool has_contact_fields = false;
  std::uint32_t all_spheres = 0;  // present and waiting ones
  std::uint32_t n = 0;            // indices for spheres in use, see WindowProgress::indices

  State now, saved;
  RebuildBuffers<Exec, Real> rebuild;
  ClosePairBuffers<Exec, Real> close;
  Buffer<WallForce<Real>> wall_force;
  TangentBuffers<Exec> tangents;
  ContactFieldBuffers<Exec, Real> contact_fields;  // empty unless frames have them
  SnapshotBuffers<Exec, Real> snapshot;            // empty unless frames have the spheres
  WindowBuffers<Exec> window;
  SurfaceBuffers<Exec> surface;
  Buffer<PairExtras<Real>> extras;
  Buffer<CoarseLevel> coarse;
  Buffer<WallRows> wall_rows;        // of each facet; empty where nothing is summed
  Buffer<std::int64_t> wall_window;  // sums of the window
  std::uint32_t walls_with_sensors = 0;
  Buffer<std::int64_t> dissipation_window;  // empty where nothing is summed
  RankBuffers<Exec, Real> ranks;            // empty where this process has all spheres

  // `p` must be the parameters of the same scene.
  EngineMemory(Exec& exec, const EngineSetup& setup, const Parameters<Real>& p)
      : needs{Law::tangential, Law::extended && (p.rolling || p.twisting), Law::extended && p.periods.any(),
              Exec::pairs_once},
        bodies(static_cast<std::uint32_t>(setup.surface.grids.size())),
        belts(setup.surface.has_belts()),
        has_contact_fields(setup.scene.output.needs_contacts()),
        all_spheres(static_cast<std::uint32_t>(setup.spheres.size())) {
    // The largest skin includes the range of adhesion; only the remainder is for travel.
    size_levels = make_size_levels(setup.scene.dem->domain, p.periods, setup.spheres.radius, setup.skins,
                                   p.unit.exact_metres(p.range));
    surface.upload(exec, setup.surface);
    exec.upload(coarse, std::span<const CoarseLevel>(size_levels.coarse));
    if constexpr (Law::extended) {
      const std::vector<PairExtras<Real>> of_pairs = make_pair_extras<Real>(setup.scene);
      exec.upload(extras, std::span<const PairExtras<Real>>(of_pairs));
    }
    if (const WallRowPlan plan = plan_wall_rows(setup.scene, setup.surface); plan.rows > 0) {
      exec.upload(wall_rows, std::span<const WallRows>(plan.of_facet));
      wall_window.resize(std::size_t{plan.rows} * wall_sum_count);
      now.wall_sums.resize(wall_window.size());
      walls_with_sensors = plan.walls;
    }
    if (setup.scene.output.dissipation) {
      dissipation_window.resize(std::size_t{dissipation_slots} * dissipation_count);
      now.dissipated.resize(dissipation_count);
    }
    now.window.resize(1);
    window.totals.resize(total_count);
    const auto present = static_cast<std::uint32_t>(setup.spheres.size() - setup.spheres.waiting);
    resize_spheres(exec, setup.indices > 0 ? static_cast<std::uint32_t>(setup.indices) : room_for(present));
    // enlarge_lists() makes more room when a rebuild needs it.
    const auto contacts = static_cast<std::size_t>(setup.contacts * n);
    const auto pairs = static_cast<std::size_t>((Exec::pairs_once ? 0.5 : 1.0) * setup.neighbours * n);
    grow_pairs(exec, pairs);
    now.lists.grow_springs(exec, pairs + springs_behind_lists<Real>(contacts, n), needs);
    now.lists.grow_walls(exec, static_cast<std::size_t>(setup.walls * n) + 64, needs);
    grow_near(exec, static_cast<std::size_t>(setup.walls * n) + 64);
    grow_carried(contacts);
    window.grow(setup.steps, bodies, belts);
    if (has_contact_fields) contact_fields.pose.resize(bodies);
    // Later it grows with the next snapshot only, because another thread may be reading it.
    if (setup.scene.output.particles)
      snapshot.for_each(now.spheres, 0, needs, [](const auto& from, auto& to) { to.resize(from.size()); });
    if (has_bodies()) {
      tangents.of_run.resize(std::size_t{tangent_runs} * bodies);
      tangents.sum.resize(bodies);
    }
  }

  bool has_bodies() const { return bodies > 1; }  // besides the ground
  // Indices for so many spheres and some more, but no more than the run has spheres.
  std::uint32_t room_for(std::uint32_t spheres) const {
    return std::min(all_spheres, spheres + std::max(spheres / 4, 64u));
  }
  // Including cells for spheres that are in no cell of the grid.
  std::uint32_t cells() const { return size_levels.finest_cells() + n / indices_per_parked_cell + 1; }
  std::uint32_t coarse_cells() const {
    return size_levels.coarse.empty() ? 0 : size_levels.coarse_cells() + n / indices_per_parked_cell + 1;
  }

  // Lists keep their lengths. The caller must initialise new indices. Arrays that are too short get `room`.
  void resize_spheres(Exec& exec, std::uint32_t count, std::uint32_t room = 0) {
    n = now.host_window.indices = count;
    const std::uint32_t length = now.spheres.position[0].size() < count ? std::max(count, room) : count;
    now.spheres.grow(exec, length, needs);
    now.lists.grow_spheres(exec, length, needs);
    exec.grow(rebuild.source, length);
    exec.grow(rebuild.count, length + 1);
    exec.grow(rebuild.cell_start, cells() + 2);
    if (!size_levels.coarse.empty()) {
      exec.grow(rebuild.coarse_start, coarse_cells() + 2);
      exec.grow(rebuild.coarse_index, length);
    }
    grow_pairs(exec, 0);
    if (has_contact_fields) contact_fields.of_sphere.resize(n);
  }
  void grow_pairs(Exec& exec, std::size_t entries) {
    now.lists.grow_pairs(exec, entries + Exec::read_ahead, needs);
    if (needs.pairs_once) close.resize(now.lists.mirror.size(), n, needs);
    if (has_contact_fields) contact_fields.of_pair.resize(now.lists.pairs.entry.size());
  }
  void grow_near(Exec& exec, std::size_t pairs) {
    exec.grow(now.lists.near, pairs);
    wall_force.resize(now.lists.near.size());
    if (has_bodies()) tangents.of_pair.resize(now.lists.near.size());
  }
  void grow_carried(std::size_t contacts) {
    if (needs.rolling) rebuild.carried_rolling.resize(contacts);
  }

  // Error{resource} where labels cannot refer to so many entries of ListBuffers::near.
  void expect_near(std::size_t entries) const {
    if (entries > Label::most_near)
      throw Error(ErrorCode::resource,
                  std::to_string(entries) + " times a sphere is near a body's walls; " +
                      std::to_string(Label::most_near) + " can be told apart",
                  "dem", "use fewer spheres");
  }

  // To be called when a rebuild did not fit; it left state and lists as they were. `wanted` has the lengths
  // that it needs.
  void enlarge_lists(Exec& exec, const WindowProgress& wanted) {
    expect_near(wanted.near_entries);
    // Spare room: a part of the entries. Of many entries it is a sixteenth of that part, to save memory.
    // While spheres come in, lists grow with them and get more.
    const bool coming = n < all_spheres;
    const auto with_spare = [coming](std::size_t entries, std::size_t part, std::size_t few) {
      return entries +
             (coming ? entries / 4 : std::max(entries / (16 * part), std::min(entries / part, few)));
    };
    const std::uint64_t pairs = std::max<std::uint64_t>(wanted.list_entries, wanted.listed),
                        springs = pairs + springs_behind_lists<Real>(wanted.carried_entries, n);
    const ContactLists<Real> room = now.lists.view(needs);
    if (pairs > room.pair_capacity) grow_pairs(exec, with_spare(pairs, 64, 1u << 16));
    if (springs > room.spring_capacity)
      now.lists.grow_springs(exec, with_spare(springs, 64, 1u << 16), needs);
    if (wanted.wall_entries > room.wall_capacity)
      now.lists.grow_walls(exec, with_spare(wanted.wall_entries, 4, 1u << 12), needs);
    if (wanted.near_entries > room.near_capacity)
      grow_near(exec, with_spare(wanted.near_entries, 4, 1u << 12));
    if (wanted.carried_entries > rebuild.carried_rolling.size())
      grow_carried(wanted.carried_entries + wanted.carried_entries / 8);
    // Without this check a rebuild that still does not fit would be repeated for ever.
    const ContactLists<Real> made = now.lists.view(needs);
    if (pairs > made.pair_capacity || springs > made.spring_capacity ||
        wanted.wall_entries > made.wall_capacity || wanted.near_entries > made.near_capacity ||
        (needs.rolling && wanted.carried_entries > rebuild.carried_rolling.size()))
      throw Error(ErrorCode::internal, "lists do not fit into the room that was made for them", "rebuild");
  }

  // Sets everything in `view` that is an array, or the length of one.
  void show(View<Real>& view) {
    view.spheres = now.spheres.view(n);
    view.window = now.window.data();
    view.lists = now.lists.view(needs);
    view.close = close.view();
    view.wall_force = wall_force.data();
    std::copy(std::begin(size_levels.finest), std::end(size_levels.finest), view.grid.finest);
    view.grid.levels = 1 + static_cast<std::uint32_t>(size_levels.coarse.size());
    view.grid.largest_of_finest = view.parameters.unit.count(size_levels.largest_of_finest);
    view.grid.coarse = coarse.data();
    view.rebuild = rebuild.view();
    view.extras = extras.data();
    view.surface = surface.view(bodies);
    if (belts) view.belts = {window.belt_velocity.data(), window.belt_pull.data()};
    if (wall_rows.size() > 0) view.wall_sums.rows = wall_rows.data(), view.wall_sums.sum = wall_window.data();
    view.dissipation.sum = data_or_none(dissipation_window);
    view.dissipation.of_pair = Exec::pairs_once ? 2 : 1;
    view.pose = window.pose.data();
    view.load = window.load.data();
    view.totals = window.totals.data();
  }

  // Bytes of all arrays, including the host's copy of the loads as sums and as forces.
  std::size_t bytes() const {
    std::size_t sum = 0;
    const auto add = [&sum](const auto& buffer) { sum += buffer.size() * sizeof(*buffer.data()); };
    for (const State* state : {&now, &saved})
      for_each_buffer([&](const std::string&, const auto& buffer) { add(buffer); }, *state);
    rebuild.for_each(add);
    close.for_each(add);
    tangents.for_each(add);
    contact_fields.for_each(add);
    snapshot.for_each(add);
    ranks.for_each(add);
    window.for_each(add);
    surface.for_each(add);
    add(wall_force);
    add(extras);
    add(coarse);
    add(wall_rows);
    add(wall_window);
    add(dissipation_window);
    if constexpr (Exec::on_host)
      sum += window.load.size() * sizeof(std::int64_t) + window.pose.size() * sizeof(Wrench);
    return sum;
  }
};

}  // namespace tandem::dem
