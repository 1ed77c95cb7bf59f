#include "mbd_server/solve/modes.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

using Eigen::MatrixXd;

// N (N^T A N)^-1 N^T for the null space N of the constraints, in coordinates relative to their scales.
MatrixXd compliance(const Model& model, MachineSystem& system, const MatrixWeights& weights) {
  const Eigen::Index n = model.freedoms;
  MatrixXd S(n, n);
  VectorXd r(n), x(n), lambda(model.equations);
  const VectorXd phi = VectorXd::Zero(model.equations), zero = VectorXd::Zero(n);
  system.factorise(weights, zero);
  for (Eigen::Index j = 0; j < n; ++j) {
    r.setZero();
    r[j] = 1 / model.scale[j];
    system.solve(r, phi, x, lambda);
    S.col(j) = x.cwiseQuotient(model.scale);
  }
  return S;
}

// Also sets the multipliers of the state.
void expect_rest(const Model& model, MachineSystem& system, State& state) {
  state.udot.setZero();
  VectorXd dx = VectorXd::Zero(model.freedoms), dlambda = VectorXd::Zero(model.equations);
  for (int iteration = 0; iteration < 2;
       ++iteration) {  // the equation is linear; the second one is round-off
    const VectorXd& r = system.residual(state);
    system.factorise({.mass = 1, .damping = 0, .stiffness = 0}, VectorXd::Zero(model.freedoms));
    system.solve(r, system.constraint(Level::acceleration), dx, dlambda);
    state.lambda -= dlambda;
    if (iteration == 0) system.shrink(state.lambda);
  }
  // Of a fall under gravity, or of a turn in the time in which the machine turns by a radian.
  const double scale = model.gravity.norm() / model.size + std::pow(system.norm(state.u), 2);
  const double acceleration = system.norm(dx);
  if (acceleration > 1e-6 * std::max(scale, 1e-6))
    throw Error(
        ErrorCode::scene,
        fmt::format("the machine does not stay as it is: it accelerates by {:.3g} rad/s2 or sizes of the "
                    "machine per s2, most at {}",
                    acceleration, system.worst(dx)),
        "mbd", "take the modes about its equilibrium, or give configuration and rates at which it stays");
  system.residual(state);
}

// Orthonormal basis of the range of a symmetric matrix.
MatrixXd range(const MatrixXd& S) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver((S + S.transpose()) / 2);
  const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  const Eigen::Index n = S.rows();
  Eigen::Index first = 0;
  // The masses of a machine may differ by many orders; compliances of excluded directions are round-off.
  while (first < n && !(solver.eigenvalues()[first] > 1e-12 * largest)) ++first;
  return solver.eigenvectors().rightCols(n - first);
}

}  // namespace

double Mode::frequency() const {
  return std::abs(s) / (2 * std::numbers::pi);
}
double Mode::damping_ratio() const {
  return std::abs(s) > 0 ? -s.real() / std::abs(s) : 0;
}

Modes find_modes(const Model& model, MachineSystem& system, State state) {
  Modes result;
  if (!model.state_names.empty())
    throw Error(
        ErrorCode::scene,
        "the modes are not computed with states of first order, here the " + model.state_names.front(),
        "mbd.forces", "leave out the integral, filter or hydraulics");
  if (model.freedoms == 0) return result;
  expect_rest(model, system, state);
  const MatrixXd of_mass = compliance(model, system, {.mass = 1, .damping = 0, .stiffness = 0});
  const MatrixXd N = range(of_mass);
  const Eigen::Index m = N.cols();
  if (m == 0) return result;
  const auto reduced = [&](const MatrixXd& S) -> MatrixXd { return (N.transpose() * S * N).inverse(); };
  const MatrixXd M = reduced(of_mass);
  // The square of the largest natural frequency, roughly: with it no part of the sums below is round-off.
  const MatrixXd stiffened = reduced(compliance(model, system, {.mass = 1, .damping = 0, .stiffness = 1}));
  const Eigen::LLT<MatrixXd> cholesky(M);
  if (cholesky.info() != Eigen::Success)
    throw Error(ErrorCode::numerics, "the mass matrix of the machine is not positive", "mbd_server",
                "give every moving body mass and inertia");
  const MatrixXd K = stiffened - M;
  const MatrixXd damped = reduced(compliance(model, system, {.mass = 1, .damping = 1, .stiffness = 0}));
  const MatrixXd C = damped - M;

  // x' = v, v' = -M^-1 (K x + C v)
  MatrixXd A = MatrixXd::Zero(2 * m, 2 * m);
  A.topRightCorner(m, m).setIdentity();
  A.bottomLeftCorner(m, m) = -cholesky.solve(K);
  A.bottomRightCorner(m, m) = -cholesky.solve(C);
  const Eigen::EigenSolver<MatrixXd> solver(A);
  if (solver.info() != Eigen::Success)
    throw Error(ErrorCode::numerics, "the eigenvalues of the machine were not found", "mbd_server",
                "check its masses and stiffnesses for extreme values");
  const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  // s = 0 is a double root where neither spring nor damper acts: round-off e makes it sqrt(e).
  const double zero = 1e-7 * largest;
  int at_zero = 0;
  for (Eigen::Index i = 0; i < 2 * m; ++i) {
    const std::complex<double> s = solver.eigenvalues()[i];
    if (std::abs(s) <= zero) {
      ++at_zero;
      continue;
    }
    if (s.imag() < 0) continue;
    Mode mode{.s = s, .shape = N * solver.eigenvectors().col(i).head(m)};
    Eigen::Index widest = 0;
    mode.shape.cwiseAbs().maxCoeff(&widest);
    mode.shape /= std::complex<double>(mode.shape[widest]);
    result.modes.push_back(std::move(mode));
  }
  std::sort(result.modes.begin(), result.modes.end(),
            [](const Mode& a, const Mode& b) { return std::abs(a.s) < std::abs(b.s); });
  result.neutral = (at_zero + 1) / 2;
  return result;
}

}  // namespace tandem::mbd
