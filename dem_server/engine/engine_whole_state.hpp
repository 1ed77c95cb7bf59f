// The engine's members for the state of all ranks (engine/listed_spheres.hpp), on the host. It is that of one
// process whose arrays have no spare room.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "dem_server/engine/engine_of.hpp"
#include "particles/backend/cpu/host_exec.hpp"

namespace tandem::dem {

// Memory of the host with the layout of a back end.
template <class Exec>
struct HostCopy {
  template <class T>
  using Buffer = particles::HostExec::Buffer<T>;
  static constexpr bool pairs_once = Exec::pairs_once;
  static constexpr std::size_t read_ahead = Exec::read_ahead;

  template <class T>
  void grow(Buffer<T>& b, std::size_t n) {
    if (b.size() < n) b.resize(n);
  }
  template <class T>
  void download(const Buffer<T>& from, std::span<T> to) {
    std::copy_n(from.data(), to.size(), to.begin());
  }
};

// A view of the spheres, the lists and the progress of a state.
template <class Exec, class Real>
View<Real> view_of(EngineState<Exec, Real>& state, const View<Real>& other, const Needs& needs) {
  View<Real> view = other;
  view.spheres = state.spheres.view(state.host_window.indices);
  view.lists = state.lists.view(needs);
  view.window = state.window.data();
  return view;
}

template <BackEnd Exec, class Law, class Real>
EngineState<HostCopy<Exec>, Real> EngineOf<Exec, Law, Real>::copy_on_host() {
  EngineState<HostCopy<Exec>, Real> copy;
  for_each_buffer(
      [this](const std::string&, const auto& from, auto& to) {
        using T = std::remove_cvref_t<decltype(*to.data())>;
        to.resize(from.size());
        if (to.size() > 0) exec_.download(from, std::span<T>(to.data(), to.size()));
      },
      memory_.now, copy);
  copy.host_window = memory_.now.host_window;
  copy.totals = memory_.now.totals;
  return copy;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::write_whole(const ArraySink& sink) {
  const Needs& needs = memory_.needs;
  EngineState<HostCopy<Exec>, Real> part = copy_on_host();
  std::vector<std::uint32_t> ordinal_here(memory_.n);
  exec_.download(memory_.ranks.ordinal, std::span<std::uint32_t>(ordinal_here));
  ListedSpheres<Real> spheres =
      listed_spheres<Real>(view_of(part, view_, needs), needs, share_.owned, ordinal_here);
  spheres.transform([this]<class T>(const std::vector<T>& own) { return gathered(std::span(own), false); });
  if (ranks_->rank() > 0) return;
  std::vector<std::uint32_t> ordinal(spheres.size());
  std::iota(ordinal.begin(), ordinal.end(), 0u);
  EngineState<HostCopy<Exec>, Real> whole;
  whole.host_window = part.host_window;
  whole.wall_sums = part.wall_sums;
  whole.dissipated = part.dissipated;
  whole.totals = part.totals;
  HostCopy<Exec> host;
  store_spheres(host, needs, spheres, ordinal, static_cast<std::uint32_t>(fewest_indices()), whole);
  write_state(host, whole, sink);
}

// Replaces the state of all ranks by what this one has of it until the next rebuild.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::take_part() {
  EngineState<HostCopy<Exec>, Real> state = copy_on_host();
  const std::uint32_t used = state.host_window.used;
  std::vector<std::uint32_t> ordinal(state.host_window.indices);
  std::iota(ordinal.begin(), ordinal.end(), 0u);
  const Range own = equal_share(used, ranks_->rank(), ranks_->size());
  std::vector<std::uint32_t> ordinal_here;
  const ListedSpheres<Real> part =
      part_of(listed_spheres<Real>(view_of(state, view_, memory_.needs), memory_.needs, {0, used}, ordinal),
              memory_.needs, own, ordinal_here);
  HostCopy<Exec> host;
  store_spheres(host, memory_.needs, part, ordinal_here, 0, state);
  for_each_buffer(
      [this](const std::string&, const auto& from, auto& to) {
        using T = std::remove_cvref_t<decltype(*to.data())>;
        to.resize(from.size());
        if (to.size() > 0) exec_.upload(to, std::span<const T>(from.data(), from.size()));
      },
      state, memory_.now);
  memory_.now.host_window = state.host_window;
  exec_.upload(memory_.ranks.ordinal, std::span<const std::uint32_t>(ordinal_here));
  const auto index_of = [&](std::uint32_t ordinal_wanted) {
    const auto at = std::ranges::lower_bound(ordinal_here, ordinal_wanted);
    return static_cast<std::uint32_t>(at - ordinal_here.begin());
  };
  share_.all = used;
  const WindowProgress& progress = state.host_window;
  share_.ends = {progress.listed, static_cast<std::uint32_t>(progress.wall_entries), progress.near};
  share_.first_ordinal = own.begin;
  share_.owned = {index_of(own.begin), index_of(own.end)};
  share_.links.clear();
  for (unsigned rank = 0; rank < ranks_->size(); ++rank) {
    const Range of_rank = equal_share(used, rank, ranks_->size());
    if (rank != ranks_->rank())
      share_.links.push_back({rank, {}, {index_of(of_rank.begin), index_of(of_rank.end)}});
  }
  link_to_ghosts(state.lists.view(memory_.needs), part.size());
}

// Own spheres are ghosts where a sphere is that has a pair with them.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::link_to_ghosts(const ContactLists<Real>& lists, std::uint32_t spheres) {
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
  for (std::uint32_t i = 0; i < spheres; ++i)
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
