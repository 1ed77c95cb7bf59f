// Sparse Cholesky factorisation A = L L^T of a symmetric positive definite matrix of 6 x 6 blocks, in an
// order of approximate minimum degree. The order is kept while the places of the blocks stay.
#pragma once

#include <vector>

#include "mbd_server/time_stepping/block_matrix.hpp"

namespace tandem::mbd {

class BlockCholesky {
 public:
  // Throws Error{numerics} where the matrix is not positive definite.
  void factorise(const BlockMatrix& A);
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

  std::vector<BlockMatrix::Pair> pairs_;
  std::vector<int> place_of_;       // of each row in the order
  std::vector<int> first_, later_;  // the later places that a place is coupled to (places + 1), (blocks)
  std::vector<Entry> entries_;      // (pairs)
  std::vector<Matrix6d> diagonal_, lower_;  // (places), (blocks)
  std::vector<Vector6d> right_;             // (places)
  std::size_t products_ = 0;
};

}  // namespace tandem::mbd
