// The engine's members for ranks (engine/rank_share.hpp). A rebuild of the lists begins with
//
//   redistribute: choose the cells of the ranks by the work of the spheres; send each sphere and its contacts
//   to the rank that will move it, and to those that will have it as a ghost (engine/travelling.hpp)
//
// so that the rebuild finds arrays and old lists as though this rank had always had these spheres. It ends
// with connect_ghosts. Each step ends with an exchange of the new state of the spheres that others have as
// ghosts, and of the largest speed and the errors of all ranks, on which the next rebuild depends
// (backend/cpu/rank_exchange_cpu.hpp, backend/cuda/rank_exchange.cuh).
#pragma once

#include <algorithm>
#include <bit>
#include <vector>

#include "dem_server/engine/engine_of.hpp"
#include "dem_server/engine/rank_work.hpp"
#include "dem_server/engine/travelling.hpp"

namespace tandem::dem {

template <BackEnd Exec, class Law, class Real>
WindowProgress EngineOf<Exec, Law, Real>::present_progress() {
  WindowProgress now;
  exec_.download(memory_.now.window, std::span<WindowProgress>(&now, 1));
  return now;
}

// By counts: a time that is measured in the run would give other shares, though the same bits, each time.
template <BackEnd Exec, class Law, class Real>
CellShares EngineOf<Exec, Law, Real>::balanced_shares() {
  constexpr std::uint32_t per_block = CellShares::cells_per_block;
  const WindowProgress window = present_progress();
  const CellGrid& grid = view_.grid.finest[window.skin > window.skins.usual ? 1 : 0];
  std::vector<std::int64_t> work((grid.total + per_block - 1) / per_block);
  auto& found = memory_.ranks.work;
  // Spheres are in the order of the cells in which they were at the last rebuild, if there was one.
  const std::uint32_t together = cell_shares_.empty() ? 1 : 32;
  std::vector<PlacedWork> of_spheres((share_.owned.end - share_.owned.begin + together - 1) / together);
  exec_.grow(found, of_spheres.size());
  exec_.for_each(static_cast<std::uint32_t>(of_spheres.size()),
                 FindWork<Real>{view_, Exec::pairs_once, together, found.data()});
  if (!of_spheres.empty()) exec_.download(found, std::span<PlacedWork>(of_spheres));
  for (const PlacedWork& sphere : of_spheres)
    if (sphere.block != PlacedWork::nowhere) work[sphere.block] += sphere.work;
  ranks_->sum(work);
  return {work, ranks_->weights()};
}

template <BackEnd Exec, class Law, class Real>
Destination<Real> EngineOf<Exec, Law, Real>::destination(unsigned rank) const {
  return {cell_shares_.of(rank), largest_radius_};
}

// Chooses the cells of the ranks anew where their work differs, or is to differ otherwise than before.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::balance() {
  constexpr double even = 1.005;
  const std::vector<std::int64_t> weights = ranks_->weights();
  if (!cell_shares_.empty() && rank_imbalance_ < even && weights == shared_by_) return;
  cell_shares_ = balanced_shares();
  shared_by_ = weights;
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::redistribute() {
  memory_.rebuild.order = view_.rebuild.order = {};
  balance();
  auto& r = memory_.ranks;
  const unsigned size = ranks_->size(), here = ranks_->rank();
  const std::uint32_t own = share_.owned.end - share_.owned.begin;
  exec_.grow(r.count, own + own / 8 + 1);
  exec_.grow(r.total, 1);
  exec_.upload(r.number, std::span<const std::uint32_t>(&own, 1));
  std::vector<Travelling> to{{}};  // sums over all lower ranks
  for (unsigned rank = 0; rank < size; ++rank) {
    const Travelling before = to.back();
    Travelling count;
    if (rank != here) {
      exec_.for_each(own, CountTravelling<Law, Real>{view_, destination(rank), r.count.data()});
      exec_.exclusive_sum(r.count, own + 1);
      exec_.for_each(1, Gather<Travelling>{r.count.data(), r.number.data(), r.total.data()});
      exec_.download(r.total, std::span<Travelling>(&count, 1));
    }
    to.push_back(before + count);
    if (count.spheres == 0) continue;
    r.out.grow(exec_, to.back());
    exec_.for_each(own, PackTravelling<Law, Real>{
                            view_, r.count.data(), r.ordinal.data(), r.out.spheres.data() + before.spheres,
                            r.out.contacts.data() + before.contacts, r.out.walls.data() + before.walls});
  }
  std::vector<Travelling> of_ranks;
  for (unsigned rank = 0; rank < size; ++rank) of_ranks.push_back(to[rank + 1] - to[rank]);
  std::vector<Travelling> from{{}};
  for (const Travelling& count : exchange_values<Travelling>(*ranks_, of_ranks))
    from.push_back(from.back() + count);
  r.in.grow(exec_, from.back());
  std::vector<ExchangedArray> arrays;
  const auto exchange = [&](auto& out, auto& in, std::uint32_t Travelling::*which) {
    const auto ranges = [which](const std::vector<Travelling>& sums) {
      std::vector<Range> parts;
      for (std::size_t k = 0; k + 1 < sums.size(); ++k) parts.push_back({sums[k].*which, sums[k + 1].*which});
      return parts;
    };
    arrays.push_back(exchanged(out, ranges(to), in, ranges(from)));
  };
  exchange(r.out.spheres, r.in.spheres, &Travelling::spheres);
  if constexpr (Law::tangential) {
    exchange(r.out.contacts, r.in.contacts, &Travelling::contacts);
    exchange(r.out.walls, r.in.walls, &Travelling::walls);
  }
  rank_exchange_.exchange(exec_, arrays);
  take_in(from.back(), from[here].spheres);
}

// Takes in what has arrived in memory_.ranks.in, `from_lower` spheres of it from lower ranks.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::take_in(const Travelling& all, std::uint32_t from_lower) {
  auto& r = memory_.ranks;
  const ListEnds ends = share_.ends;
  const std::uint32_t n = share_.owned.end + all.spheres;
  memory_.resize_spheres(exec_, n, n + n / 8);
  grow_for(ends.pairs + all.contacts, ends.walls + all.walls, ends.near + all.walls);
  exec_.grow(r.ordinal, memory_.now.spheres.position[0].size());
  exec_.grow(r.count, all.spheres + 1);
  refresh_view();
  const FindOrdinal<Real> find{share_.owned, share_.first_ordinal, r.in.spheres.data(), all.spheres};
  exec_.for_each(share_.owned.end,
                 Stay<Law, Real>{view_, destination(ranks_->rank()), find, r.ordinal.data()});
  exec_.for_each(all.spheres, CountArrived<Real>{r.in.spheres.data(), r.count.data()});
  exec_.exclusive_sum(r.count, all.spheres + 1);
  exec_.for_each(all.spheres + 1, Unpack<Law, Real>{view_, find, ends, r.count.data(), r.in.contacts.data(),
                                                    r.in.walls.data()});
  memory_.rebuild.order = view_.rebuild.order = {share_.owned.end, from_lower};
}

// Makes room for lists of these lengths, and for what a rebuild carries over from them.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::grow_for(std::size_t pairs, std::size_t walls, std::size_t near) {
  const ContactLists<Real> room = memory_.now.lists.view(memory_.needs);
  const auto with_spare = [](std::size_t entries) { return entries + entries / 16 + 64; };
  if (pairs > room.pair_capacity) memory_.grow_pairs(exec_, with_spare(pairs));
  if (pairs > room.spring_capacity) memory_.now.lists.grow_springs(exec_, with_spare(pairs), memory_.needs);
  if (walls > room.wall_capacity) memory_.now.lists.grow_walls(exec_, with_spare(walls), memory_.needs);
  memory_.expect_near(near);
  if (near > room.near_capacity) memory_.grow_near(exec_, with_spare(near));
}

// To be called when the spheres have been sorted into cells.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::find_own_and_ghosts() {
  auto& r = memory_.ranks;
  std::vector<std::uint32_t> cells;
  for (unsigned rank = 0; rank < ranks_->size(); ++rank) cells.push_back(cell_shares_.of(rank).begin);
  cells.push_back(cell_shares_.of(ranks_->size() - 1).end);
  std::vector<std::uint32_t> first(cells.size());
  exec_.upload(r.number, std::span<const std::uint32_t>(cells));
  exec_.grow(r.sent, cells.size());
  exec_.for_each(static_cast<std::uint32_t>(cells.size()),
                 Gather<std::uint32_t>{memory_.rebuild.cell_start.data(), r.number.data(), r.sent.data()});
  exec_.download(r.sent, std::span<std::uint32_t>(first));
  share_.owned = view_.spheres.owned = {first[ranks_->rank()], first[ranks_->rank() + 1]};
  share_.links.clear();
  for (unsigned rank = 0; rank < ranks_->size(); ++rank)
    if (rank != ranks_->rank()) share_.links.push_back({rank, {}, {first[rank], first[rank + 1]}});
}

// Steps keep the state of parked spheres only where they are among the own ones. They come last.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::leave_out_parked() {
  std::uint32_t present = share_.owned.end;
  for (const GhostLink& link : share_.links) present = std::max(present, link.ghosts.end);
  memory_.resize_spheres(exec_, present);
  refresh_view();
  exec_.for_each(1, SetIndices<Real>{view_});
}

// To be called when the lists are built.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::connect_ghosts() {
  auto& r = memory_.ranks;
  const std::uint32_t own = share_.owned.end - share_.owned.begin;
  exec_.upload(r.number, std::span<const std::uint32_t>(&own, 1));
  exec_.grow(r.flag, own + own / 8 + 1);
  exec_.grow(r.sent, 1);
  std::uint32_t listed = 0;
  for (GhostLink& link : share_.links) {
    exec_.for_each(own, FindGhosts<Real>{view_, destination(link.rank), r.flag.data()});
    exec_.exclusive_sum(r.flag, own + 1);
    exec_.for_each(1, Gather<std::uint32_t>{r.flag.data(), r.number.data(), r.sent.data()});
    std::uint32_t count = 0;
    exec_.download(r.sent, std::span<std::uint32_t>(&count, 1));
    link.send = {listed, listed + count};
    listed += count;
    if (r.send.size() < listed) exec_.grow(r.send, listed + listed / 4);
    exec_.for_each(own, ListGhosts{r.flag.data(), share_.owned.begin, r.send.data() + link.send.begin});
  }
  count_all_ranks();
  std::erase_if(share_.links, [](const GhostLink& link) {
    return link.send.begin == link.send.end && link.ghosts.begin == link.ghosts.end;
  });
  rank_exchange_.connect(exec_, share_.links, r.send);
  number_ghosts();
}

// Counts the spheres of all ranks, gives the own ones their ordinals, and compares the work of the ranks.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::count_all_ranks() {
  auto& r = memory_.ranks;
  const Range own = share_.owned;
  const std::vector<std::uint32_t> bounds{own.begin, own.end};
  exec_.upload(r.number, std::span<const std::uint32_t>(bounds));
  exec_.grow(r.sent, 2);
  const auto entries = [&](const std::uint32_t* start) {
    std::uint32_t ends[2];
    exec_.for_each(2, Gather<std::uint32_t>{start, r.number.data(), r.sent.data()});
    exec_.download(r.sent, std::span<std::uint32_t>(ends));
    return std::int64_t{ends[1]} - ends[0];
  };
  struct Count {
    std::int64_t spheres, work;
  };
  Count here{std::int64_t{own.end} - own.begin, 0};
  here.work = 2 * here.spheres + entries(view_.lists.pairs.start);
  if constexpr (Exec::pairs_once) here.work += entries(view_.lists.mirror_start);
  const std::vector<Count> of_ranks(ranks_->size(), here);
  std::int64_t spheres = 0, work = 0, most = 0;
  const std::vector<Count> counts = exchange_values<Count>(*ranks_, of_ranks);
  for (unsigned rank = 0; rank < counts.size(); ++rank) {
    if (rank == ranks_->rank()) share_.first_ordinal = static_cast<std::uint32_t>(spheres);
    spheres += counts[rank].spheres, work += counts[rank].work;
    most = std::max(most, counts[rank].work);
  }
  rank_imbalance_ = work > 0 ? static_cast<double>(most) * ranks_->size() / static_cast<double>(work) : 1;
  share_.all = static_cast<std::uint32_t>(spheres);
  exec_.grow(r.ordinal, memory_.n);
  exec_.for_each(own.end - own.begin, CountUp{r.ordinal.data() + own.begin, share_.first_ordinal});
}

template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::number_ghosts() {
  auto& r = memory_.ranks;
  std::vector<Range> to(ranks_->size()), from(ranks_->size());
  std::uint32_t sent = 0;
  for (const GhostLink& link : share_.links) {
    to[link.rank] = link.send, from[link.rank] = link.ghosts;
    sent = std::max(sent, link.send.end);
  }
  exec_.grow(r.sent, sent);
  exec_.for_each(sent, Gather<std::uint32_t>{r.ordinal.data(), r.send.data(), r.sent.data()});
  const ExchangedArray ordinals = exchanged(r.sent, to, r.ordinal, from);
  rank_exchange_.exchange(exec_, {&ordinals, 1});
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
  exec_.grow(memory_.ranks.ordinal, share_.owned.end);
  exec_.for_each(count, CountUp{memory_.ranks.ordinal.data() + first, ordinal});
  if (share_.owned.end > memory_.n) enlarge_spheres(share_.owned.end);
  refresh_view();
  return first;
}

// To be called when the own spheres have moved.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::finish_step() {
  if (ranks_ != nullptr) rank_exchange_.end_step(exec_, view_);
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
