// What ranks exchange while the spheres are in the memory of the host.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/contact/ghosts.hpp"
#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/ranks.hpp"

namespace tandem::dem {

template <class Real, bool with_spin>
class CpuRankExchange {
 public:
  explicit CpuRankExchange(Ranks* ranks) : ranks_(ranks) {}

  template <class Exec>
  void exchange(Exec&, std::span<const ExchangedArray> arrays) {
    const auto part = [](std::byte* begin, std::size_t entry, Range range) {
      return std::span(begin + range.begin * entry, (range.end - range.begin) * entry);
    };
    for (const ExchangedArray& array : arrays) {
      std::vector<Ranks::Parcel> outgoing, incoming;
      for (unsigned rank = 0; rank < ranks_->size(); ++rank) {
        if (rank == ranks_->rank()) continue;
        if (array.to[rank].begin < array.to[rank].end)
          outgoing.push_back({rank, part(array.out, array.entry, array.to[rank])});
        if (array.from[rank].begin < array.from[rank].end)
          incoming.push_back({rank, part(array.in, array.entry, array.from[rank])});
      }
      ranks_->swap(outgoing, incoming);
    }
  }

  // To be called when the ghosts have changed, which they have on all ranks. `send`: see GhostLink.
  template <class Exec, class Buffer>
  void connect(Exec&, const std::vector<GhostLink>& links, const Buffer& send) {
    links_ = links;
    send_ = send.data();
    std::uint32_t sent = 0, ghosts = 0;
    for (const GhostLink& link : links) {
      sent = std::max(sent, link.send.end);
      ghosts += link.ghosts.end - link.ghosts.begin;
    }
    out_.resize(sent);
    in_.resize(ghosts);
  }

  // Gives the ghosts of all ranks the present state of their spheres.
  template <class Exec>
  void refresh(Exec& exec, const View<Real>& view, std::uint32_t side) {
    begin(exec, view, side);
    finish(exec, view, side);
  }
  // The same at the end of a micro step, with what all ranks report of it.
  template <class Exec>
  void end_step(Exec& exec, const View<Real>& view) {
    const std::uint32_t side = view.window->progress[0].state_side ^ 1;
    begin(exec, view, side);
    combine(*view.window);  // while the messages are under way
    finish(exec, view, side);
  }

 private:
  using Ghost = GhostState<Real, with_spin>;

  template <class Exec>
  void begin(Exec& exec, const View<Real>& view, std::uint32_t side) {
    exec.for_each(static_cast<std::uint32_t>(out_.size()),
                  [&](std::uint32_t k) { out_[k] = Ghost::of(view.spheres, side, send_[k]); });
    std::vector<Ranks::Parcel> to, from;
    Ghost* at = in_.data();
    for (const GhostLink& link : links_) {
      const std::uint32_t sent = link.send.end - link.send.begin,
                          ghosts = link.ghosts.end - link.ghosts.begin;
      if (sent > 0)
        to.push_back({link.rank, std::as_writable_bytes(std::span(out_.data() + link.send.begin, sent))});
      if (ghosts > 0) from.push_back({link.rank, std::as_writable_bytes(std::span(at, ghosts))});
      at += ghosts;
    }
    ranks_->begin_swap(to, from);
  }
  template <class Exec>
  void finish(Exec& exec, const View<Real>& view, std::uint32_t side) {
    ranks_->end_swap();
    const Ghost* at = in_.data();
    for (const GhostLink& link : links_) {
      const std::uint32_t ghosts = link.ghosts.end - link.ghosts.begin;
      exec.for_each(ghosts, [&](std::uint32_t k) { at[k].store(view.spheres, side, link.ghosts.begin + k); });
      at += ghosts;
    }
  }
  // The next rebuild depends on the largest speed.
  void combine(WindowProgress& window) {
    std::uint64_t most[] = {std::bit_cast<std::uint32_t>(window.max_speed2[0]), ~window.culprit,
                            window.error};
    ranks_->maximum(most);
    window.max_speed2[0] = std::bit_cast<float>(static_cast<std::uint32_t>(most[0]));
    window.culprit = ~static_cast<std::uint32_t>(most[1]);
    if (most[2] != 0) window.error = any_of_ranks(*ranks_, window.error);
  }

  Ranks* ranks_;
  std::vector<GhostLink> links_;
  const std::uint32_t* send_ = nullptr;
  std::vector<Ghost> out_, in_;
};

}  // namespace tandem::dem
