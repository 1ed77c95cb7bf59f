#include "mbd_server/time_stepping/conjugate_gradients.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace tandem::mbd {
namespace {

// A factorisation costs as much as some hundred iterations in a heap of a thousand bodies.
constexpr int most_products = 60;

double product(const std::vector<Vector6d>& a, const std::vector<Vector6d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

bool ConjugateGradients::precondition(const BlockMatrix& A) {
  inverse_ = A.diagonal;
  std::size_t k = 0;
  for (std::size_t i = 0; i < inverse_.size(); ++i) {
    const Eigen::LLT<Matrix6d> llt(inverse_[i]);
    if (llt.info() != Eigen::Success) return false;
    inverse_[i] = llt.solve(Matrix6d::Identity());
    for (; k < A.pairs.size() && as_index(A.pairs[k].first) == i; ++k) {
      const Matrix6d half = inverse_[i].lazyProduct(A.upper[k]);
      inverse_[as_index(A.pairs[k].second)].noalias() -= A.upper[k].transpose().lazyProduct(half);
    }
  }
  return true;
}

// z = M^-1 r.
void ConjugateGradients::apply(const BlockMatrix& A, const std::vector<Vector6d>& r,
                               std::vector<Vector6d>& z) const {
  z = r;
  std::size_t k = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    z[i] = inverse_[i].lazyProduct(z[i]).eval();
    for (; k < A.pairs.size() && as_index(A.pairs[k].first) == i; ++k)
      z[as_index(A.pairs[k].second)].noalias() -= A.upper[k].transpose().lazyProduct(z[i]);
  }
  for (std::size_t i = z.size(); i-- > 0;) {
    Vector6d sum = Vector6d::Zero();
    for (; k > 0 && as_index(A.pairs[k - 1].first) == i; --k)
      sum.noalias() += A.upper[k - 1].lazyProduct(z[as_index(A.pairs[k - 1].second)]);
    z[i].noalias() -= inverse_[i].lazyProduct(sum);
  }
}

bool ConjugateGradients::solve(const BlockMatrix& A, double tolerance, std::vector<Vector6d>& r) {
  if (!precondition(A)) return false;
  residual_ = r;
  x_.assign(r.size(), Vector6d::Zero());
  Ap_.resize(r.size());
  apply(A);
  p_ = z_;
  double size = product(residual_, z_);
  const double enough = tolerance * tolerance * size;
  for (int i = 0; size > enough; ++i) {
    if (i == most_products || !std::isfinite(size)) return false;
    A.multiply(p_, Ap_);
    const double length = size / product(p_, Ap_);
    for (std::size_t k = 0; k < x_.size(); ++k) x_[k] += length * p_[k], residual_[k] -= length * Ap_[k];
    apply(A);
    const double next = product(residual_, z_);
    for (std::size_t k = 0; k < p_.size(); ++k) p_[k] = z_[k] + next / size * p_[k];
    size = next;
    ++iterations_;
  }
  r = x_;
  return true;
}

bool ConjugateGradients::solve(const BlockMatrix& A, const Add& add, double tolerance,
                               std::vector<Vector6d>& r) {
  if (!precondition(A)) return false;
  const auto multiply = [&](const std::vector<Vector6d>& x, std::vector<Vector6d>& y) {
    A.multiply(x, y);
    add(x, y);
  };
  residual_ = shadow_ = p_ = r;
  x_.assign(r.size(), Vector6d::Zero());
  Ap_.resize(r.size()), A_half_.resize(r.size()), half_.resize(r.size());
  double rho = product(shadow_, residual_);
  const double enough = tolerance * tolerance * rho;
  for (int i = 0; product(residual_, residual_) > enough; ++i) {
    if (i == most_products / 2 || !std::isfinite(rho) || rho == 0) return false;
    apply(A, p_, z_);
    multiply(z_, Ap_);
    const double alpha = rho / product(shadow_, Ap_);
    for (std::size_t k = 0; k < half_.size(); ++k) half_[k] = residual_[k] - alpha * Ap_[k];
    apply(A, half_, z_half_);
    multiply(z_half_, A_half_);
    const double size = product(A_half_, A_half_), omega = size > 0 ? product(A_half_, half_) / size : 0;
    for (std::size_t k = 0; k < x_.size(); ++k) {
      x_[k] += alpha * z_[k] + omega * z_half_[k];
      residual_[k] = half_[k] - omega * A_half_[k];
    }
    const double next = product(shadow_, residual_), beta = next / rho * alpha / omega;
    for (std::size_t k = 0; k < p_.size(); ++k) p_[k] = residual_[k] + beta * (p_[k] - omega * Ap_[k]);
    rho = next;
    iterations_ += 2;
  }
  if (!std::isfinite(product(x_, x_))) return false;
  r = x_;
  return true;
}

}  // namespace tandem::mbd
