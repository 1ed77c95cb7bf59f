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
#include <functional>
#include <vector>

#include "mbd_server/time_stepping/block_matrix.hpp"

namespace tandem::mbd {

class ConjugateGradients {
 public:
  // Replaces r by x, to `tolerance` of it in the norm of the preconditioner, and returns true. Where the
  // preconditioner is not positive definite, or the solution takes too many iterations, r stays.
  bool solve(const BlockMatrix& A, double tolerance, std::vector<Vector6d>& r);
  // Replaces r by the solution of (A + B) x = r, where `add` adds B x to its second argument and B is not
  // symmetric, with the preconditioner of A (BiCGSTAB, [Barrett1994]). As solve() otherwise.
  using Add = std::function<void(const std::vector<Vector6d>& x, std::vector<Vector6d>& y)>;
  bool solve(const BlockMatrix& A, const Add& add, double tolerance, std::vector<Vector6d>& r);
  std::uint64_t iterations() const { return iterations_; }

 private:
  bool precondition(const BlockMatrix& A);
  void apply(const BlockMatrix& A) { apply(A, residual_, z_); }
  void apply(const BlockMatrix& A, const std::vector<Vector6d>& r, std::vector<Vector6d>& z) const;

  std::vector<Matrix6d> inverse_;  // of P (rows)
  std::vector<Vector6d> x_, residual_, z_, p_, Ap_;
  std::vector<Vector6d> shadow_, half_, A_half_, z_half_;  // of the matrix that is not symmetric
  std::uint64_t iterations_ = 0;
};

}  // namespace tandem::mbd
