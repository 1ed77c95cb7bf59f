// Which spheres a rank has (particles/base/ranks.hpp), and which of them its neighbours need.
//
// Spheres are sorted by cell, and the cells have one order (particles/grid/cell_grid.hpp). Rank r moves the
// spheres in a range of that order, and has ghosts: copies of the spheres of other ranks near its own. Its
// arrays have all of these in the order of cells, so that
//
//   ghosts of lower ranks | own spheres | ghosts of higher ranks
//
// and the spheres around an own sphere come in the order in which one process would find them. Forces are
// summed in that order: the number of ranks changes no bit.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "dem_server/contact/ghosts.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/range.hpp"
#include "particles/grid/cell_grid.hpp"

namespace tandem::dem {

// The entries of index i in a list that begins at start[i]; none for spheres that came in since it was built.
TANDEM_HD inline Range entries_of(const std::uint32_t* start, std::uint32_t i) {
  return {start[i], start[i] < start[i + 1] ? start[i + 1] : start[i]};
}

// The range of cells of each rank.
class CellShares {
 public:
  static constexpr std::uint32_t cells_per_block = 64;  // see CellGrid

  CellShares() = default;
  // `work`: of the spheres in each block of cells. A rank gets about its share of it, see Ranks::weights().
  CellShares(const std::vector<std::int64_t>& work, const std::vector<std::int64_t>& weights) : first_{0} {
    const auto sum = [](const std::vector<std::int64_t>& values) {
      return std::accumulate(values.begin(), values.end(), std::int64_t{0});
    };
    const std::int64_t all = sum(work), weight = sum(weights);
    std::int64_t before = 0, weight_before = weights.front();
    for (std::size_t block = 0; block < work.size(); ++block) {
      while (first_.size() < weights.size() && before * weight >= all * weight_before) {
        weight_before += weights[first_.size()];
        first_.push_back(static_cast<std::uint32_t>(block) * cells_per_block);
      }
      before += work[block];
    }
    first_.resize(weights.size() + 1, static_cast<std::uint32_t>(work.size()) * cells_per_block);
  }

  bool empty() const { return first_.empty(); }
  Range of(unsigned rank) const { return {first_[rank], first_[rank + 1]}; }
  unsigned owner(std::uint32_t cell) const {
    return static_cast<unsigned>(std::upper_bound(first_.begin() + 1, first_.end() - 1, cell) -
                                 (first_.begin() + 1));
  }

 private:
  std::vector<std::uint32_t> first_;  // of each rank, and the end
};

// Of `count` things in order, the part of a rank.
inline Range equal_share(std::uint32_t count, unsigned rank, unsigned ranks) {
  const auto begin = [&](std::uint64_t of) { return static_cast<std::uint32_t>(count * of / ranks); };
  return {begin(rank), begin(std::uint64_t{rank} + 1)};
}

// Lengths of lists.
struct ListEnds {
  std::uint32_t pairs = 0, walls = 0, near = 0;
};

struct RankShare {
  Range owned;                      // see SphereArrays
  std::uint32_t first_ordinal = 0;  // of the own spheres: their indices where one process had all spheres
  std::uint32_t all = 0;            // spheres of all ranks
  std::vector<GhostLink> links;
  ListEnds ends;  // of the lists here
};

}  // namespace tandem::dem
