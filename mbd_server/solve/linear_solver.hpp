// The linear systems of Newton's method: one factorisation, many right-hand sides. The only place that knows
// how the iteration matrix is stored and eliminated.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace tandem::mbd {

class LinearSolver {
 public:
  explicit LinearSolver(Eigen::Index size) : matrix_(size, size), factors_(size) {}

  Eigen::MatrixXd& matrix() { return matrix_; }
  // Factorises matrix(). Returns the index of a coordinate whose pivot vanishes, or -1.
  Eigen::Index factorise();
  // x = matrix^-1 b
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) const;

 private:
  Eigen::MatrixXd matrix_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

}  // namespace tandem::mbd
