// Solves A x = r for a symmetric positive definite matrix of blocks by conjugate gradients, with an
// incomplete factorisation without fill as preconditioner: A = L + D + L^T is taken for
//
//   (P + L) P^-1 (P + L)^T
//
// with blocks P by which the diagonal is that of A (DILU, [Barrett1994]). It is exact for chains and stacks
// in their order. A solution costs a few products of A with a vector, however many bodies there are, unless
// the contacts are much stiffer than the bodies are heavy.
#pragma once

#include <cstdint>
#include <vector>

#include "mbd_server/time_stepping/block_matrix.hpp"

namespace tandem::mbd {

class ConjugateGradients {
 public:
  // Replaces r by x, to `tolerance` of it in the norm of the preconditioner, and returns true. Where the
  // preconditioner is not positive definite, or the solution takes too many iterations, r stays.
  bool solve(const BlockMatrix& A, double tolerance, std::vector<Vector6d>& r);
  std::uint64_t iterations() const { return iterations_; }

 private:
  bool precondition(const BlockMatrix& A);
  void apply(const BlockMatrix& A);

  std::vector<Matrix6d> inverse_;  // of P (rows)
  std::vector<Vector6d> x_, residual_, z_, p_, Ap_;
  std::uint64_t iterations_ = 0;
};

}  // namespace tandem::mbd
