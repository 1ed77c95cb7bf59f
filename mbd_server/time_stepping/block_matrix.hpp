// A symmetric sparse matrix of 6 x 6 blocks.
#pragma once

#include <utility>
#include <vector>

#include "mbd_server/spatial/spatial.hpp"
#include "mbd_server/time_stepping/as_index.hpp"

namespace tandem::mbd {

struct BlockMatrix {
  using Pair = std::pair<int, int>;  // row and column of a block off the diagonal, first < second

  std::vector<Matrix6d> diagonal;  // (rows)
  std::vector<Pair> pairs;         // sorted
  std::vector<Matrix6d> upper;     // of the pairs; their mirror images are not stored (pairs)

  int rows() const { return static_cast<int>(diagonal.size()); }
  // y = A x
  void multiply(const std::vector<Vector6d>& x, std::vector<Vector6d>& y) const {
    for (std::size_t i = 0; i < diagonal.size(); ++i) y[i].noalias() = diagonal[i].lazyProduct(x[i]);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const std::size_t a = as_index(pairs[k].first), b = as_index(pairs[k].second);
      y[a].noalias() += upper[k].lazyProduct(x[b]);
      y[b].noalias() += upper[k].transpose().lazyProduct(x[a]);
    }
  }
};

}  // namespace tandem::mbd
