// The engine's members for the state of all ranks (engine/listed_spheres.hpp), on the host. It is that of one
// process whose arrays have no spare room.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "dem_server/engine/engine_of.hpp"

namespace tandem::dem {

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::write_whole(const ArraySink& sink) {
  const auto& now = memory_.now;
  const Needs& needs = memory_.needs;
  std::vector<std::uint32_t> ordinal_here(memory_.n);
  exec_.download(memory_.ranks.ordinal, std::span<std::uint32_t>(ordinal_here));
  ListedSpheres<Real> spheres = listed_spheres<Real>(view_, needs, share_.owned, ordinal_here);
  spheres.transform([this]<class T>(const std::vector<T>& own) { return gathered(std::span(own), false); });
  if (ranks_->rank() > 0) return;
  std::vector<std::uint32_t> ordinal(spheres.size());
  std::iota(ordinal.begin(), ordinal.end(), 0u);
  typename Memory::State whole;
  whole.host_window = now.host_window;
  whole.wall_sums = now.wall_sums;
  whole.dissipated = now.dissipated;
  whole.totals = now.totals;
  store_spheres(exec_, needs, spheres, ordinal, static_cast<std::uint32_t>(fewest_indices()), whole);
  write_state(exec_, whole, sink);
}

// Replaces the state of all ranks by what this one has of it until the next rebuild.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::take_part() {
  auto& now = memory_.now;
  const std::uint32_t used = now.host_window.used;
  View<Real> view = view_;
  view.spheres = now.spheres.view(now.host_window.indices);
  view.lists = now.lists.view(memory_.needs);
  view.window = now.window.data();
  std::vector<std::uint32_t> ordinal(now.host_window.indices);
  std::iota(ordinal.begin(), ordinal.end(), 0u);
  const Range own = equal_share(used, ranks_->rank(), ranks_->size());
  std::vector<std::uint32_t> ordinal_here;
  const ListedSpheres<Real> part = part_of(listed_spheres<Real>(view, memory_.needs, {0, used}, ordinal),
                                           memory_.needs, own, ordinal_here);
  store_spheres(exec_, memory_.needs, part, ordinal_here, 0, now);
  exec_.upload(memory_.ranks.ordinal, std::span<const std::uint32_t>(ordinal_here));
  const auto index_of = [&](std::uint32_t ordinal_wanted) {
    const auto at = std::ranges::lower_bound(ordinal_here, ordinal_wanted);
    return static_cast<std::uint32_t>(at - ordinal_here.begin());
  };
  share_.all = used;
  share_.owned = {index_of(own.begin), index_of(own.end)};
  share_.links.clear();
  for (unsigned rank = 0; rank < ranks_->size(); ++rank) {
    const Range of_rank = equal_share(used, rank, ranks_->size());
    if (rank != ranks_->rank())
      share_.links.push_back({rank, {}, {index_of(of_rank.begin), index_of(of_rank.end)}});
  }
  link_to_ghosts(part);
}

// Own spheres are ghosts where a sphere is that has a pair with them.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::link_to_ghosts(const ListedSpheres<Real>& part) {
  const ContactLists<Real> lists = memory_.now.lists.view(memory_.needs);
  const auto owns = [this](std::uint32_t i) {
    return i - share_.owned.begin < share_.owned.end - share_.owned.begin;
  };
  std::vector<std::vector<std::uint32_t>> send_to(share_.links.size());
  const auto send = [&](std::uint32_t own, std::uint32_t ghost) {
    for (std::size_t l = 0; l < share_.links.size(); ++l) {
      const Range ghosts = share_.links[l].ghosts;
      if (ghost - ghosts.begin < ghosts.end - ghosts.begin) send_to[l].push_back(own);
    }
  };
  for (std::uint32_t i = 0; i < part.size(); ++i)
    for (std::uint32_t k = lists.pairs.start[i]; k < lists.pairs.start[i + 1]; ++k) {
      const std::uint32_t j = lists.pairs.entry[k].index();
      if (owns(i) && !owns(j)) send(i, j);
      if (owns(j) && !owns(i)) send(j, i);
    }
  std::vector<std::uint32_t> all;
  for (std::size_t l = 0; l < send_to.size(); ++l) {
    std::ranges::sort(send_to[l]);
    const auto rest = std::ranges::unique(send_to[l]);
    const auto first = static_cast<std::uint32_t>(all.size());
    all.insert(all.end(), send_to[l].begin(), rest.begin());
    share_.links[l].send = {first, static_cast<std::uint32_t>(all.size())};
  }
  std::erase_if(share_.links, [](const GhostLink& link) {
    return link.send.begin == link.send.end && link.ghosts.begin == link.ghosts.end;
  });
  exec_.upload(memory_.ranks.send, std::span<const std::uint32_t>(all));
  rank_exchange_.connect(exec_, share_.links, memory_.ranks.send);
}

}  // namespace tandem::dem
