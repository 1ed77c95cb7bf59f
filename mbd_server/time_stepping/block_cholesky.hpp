// Sparse Cholesky factorisation A = L L^T of a symmetric positive definite matrix of 6 x 6 blocks, in an
// order of approximate minimum degree. The order is kept while the places of the blocks stay.
#pragma once

#include <utility>
#include <vector>

#include "mbd_server/spatial/spatial.hpp"
#include "mbd_server/time_stepping/as_index.hpp"

namespace tandem::mbd {

class BlockCholesky {
 public:
  using Pair = std::pair<int, int>;  // row and column of a block off the diagonal, first < second

  // Sets the number of rows of blocks and the blocks that are not zero, sorted; all blocks become zero.
  void begin(int rows, const std::vector<Pair>& pairs);
  Matrix6d& diagonal(int row) { return diagonal_[as_index(place_of_[as_index(row)])]; }
  // Adds to the block (first, second) of the k-th pair, and to its mirror image.
  void add(std::size_t k, const Matrix6d& block) {
    const Entry& e = entries_[k];
    lower_[as_index(e.lower)] += e.transposed ? Matrix6d(block.transpose()) : block;
  }
  // Throws Error{numerics} where the matrix is not positive definite.
  void factorise();
  // Replaces r by A^-1 r (rows).
  void solve(std::vector<Vector6d>& r);
  // Products of two blocks in a factorisation.
  std::size_t products() const { return products_; }

 private:
  struct Entry {
    int lower;        // in lower_
    bool transposed;  // whether its row is the second of the pair's
  };
  void plan(int rows);

  std::vector<Pair> pairs_;
  std::vector<int> place_of_;       // of each row in the order
  std::vector<int> first_, later_;  // the later places that a place is coupled to (places + 1), (blocks)
  std::vector<Entry> entries_;      // (pairs)
  std::vector<Matrix6d> diagonal_, lower_;  // (places), (blocks)
  std::vector<Vector6d> right_;             // (places)
  std::size_t products_ = 0;
};

}  // namespace tandem::mbd
