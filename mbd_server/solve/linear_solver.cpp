#include "mbd_server/solve/linear_solver.hpp"

#include <cmath>
#include <limits>

namespace tandem::mbd {

Eigen::Index LinearSolver::factorise() {
  if (matrix_.rows() == 0) return -1;
  factors_.compute(matrix_);
  const auto& LU = factors_.matrixLU();
  for (Eigen::Index i = 0; i < LU.rows(); ++i) {
    // Smaller than round-off of its column, or not a number.
    const double level = matrix_.col(i).cwiseAbs().maxCoeff();
    if (!(std::abs(LU(i, i)) > 4 * std::numeric_limits<double>::epsilon() * level)) return i;
  }
  return -1;
}

void LinearSolver::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) const {
  if (matrix_.rows() > 0) x.noalias() = factors_.solve(b);
}

}  // namespace tandem::mbd
