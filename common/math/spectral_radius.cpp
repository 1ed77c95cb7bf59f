#include "common/math/spectral_radius.hpp"

#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>

namespace tandem {

double spectral_radius(std::span<const double> matrix) {
  const auto n = static_cast<Eigen::Index>(std::lround(std::sqrt(static_cast<double>(matrix.size()))));
  assert(n > 0 && n * n == static_cast<Eigen::Index>(matrix.size()));
  return Eigen::Map<const Eigen::MatrixXd>(matrix.data(), n, n).eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace tandem
