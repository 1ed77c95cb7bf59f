// Small passes of the engine's members for ranks (engine/engine_ranks.hpp).
#pragma once

#include <cstdint>

#include "dem_server/engine/rank_buffers.hpp"
#include "dem_server/engine/rank_share.hpp"
#include "dem_server/laws/particle_names.hpp"

namespace tandem::dem {

// Work of an own sphere in a step, in halves of that of a pair. A sphere takes as long as a pair in its list,
// some 30 ns on a CPU [docs/experiments/2026-11-ranks.md].
//
// That of `together` spheres, which are in the block of the first of them, about.
template <class Real>
struct FindWork {
  View<Real> view;
  bool pairs_once;
  std::uint32_t together;
  PlacedWork* work;

  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t side = view.window->progress[0].state_side;
    PlacedWork found;
    for (std::uint32_t of = 0; of < together; ++of) {
      const std::uint32_t i = view.spheres.owned.begin + k * together + of;
      if (i >= view.spheres.owned.end) break;
      if (is_parked(view.spheres.position[side][i])) continue;
      if (found.block == PlacedWork::nowhere) found.block = cell_of(view, i) / CellShares::cells_per_block;
      found.work += 2;
      if (view.window->rebuilds == 0) continue;  // there are no lists yet
      const auto add = [&](const std::uint32_t* start) {
        const Range entries = entries_of(start, i);
        found.work += entries.end - entries.begin;
      };
      add(view.lists.pairs.start);
      if (pairs_once) add(view.lists.mirror_start);
    }
    work[k] = found;
  }
};

// Own spheres that a rank has as ghosts.
template <class Real>
struct FindGhosts {
  View<Real> view;
  Destination<Real> of;
  std::uint32_t* flag;
  TANDEM_HD void operator()(std::uint32_t k) const {
    flag[k] = of.needs(view, view.spheres.owned.begin + k) ? 1 : 0;
  }
};
// With the sums of the above over all lower indices.
struct ListGhosts {
  const std::uint32_t* before;
  std::uint32_t first;  // own sphere
  std::uint32_t* send;
  TANDEM_HD void operator()(std::uint32_t k) const {
    if (before[k] < before[k + 1]) send[before[k]] = first + k;
  }
};

struct CountUp {
  std::uint32_t* at;
  std::uint32_t from;
  TANDEM_HD void operator()(std::uint32_t k) const { at[k] = from + k; }
};
// to[k] = from[which[k]]
template <class T>
struct Gather {
  const T* from;
  const std::uint32_t* which;
  T* to;
  TANDEM_HD void operator()(std::uint32_t k) const { to[k] = from[which[k]]; }
};

template <class Real>
struct SetIndices {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t) const { view.window->indices = view.spheres.count; }
};

template <class Real>
struct ForgetOverflow {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t) const {
    view.window->error &= ~static_cast<std::uint32_t>(list_overflow);
  }
};

}  // namespace tandem::dem
