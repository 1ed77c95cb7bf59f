#include "mbd_server/solve/modes.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "mbd_server/forces/element_force.hpp"

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
  if (state.z.size() == 0) return;
  const VectorXd& rates = system.state_rates();
  const double changing = system.state_norm(rates);
  if (changing > 1e-6 * std::max(std::sqrt(scale), 1e-3))
    throw Error(ErrorCode::scene,
                fmt::format("the machine does not stay as it is: the {} changes by {:.3g} of its scale per s",
                            system.worst_state(rates), changing),
                "mbd",
                "take the modes about its equilibrium, or give pressures and targets at which it stays");
}

// The arguments of all elements with states: their derivatives with respect to the increments of the
// freedoms, and those of their rates (elements x freedoms).
struct Arguments {
  MatrixXd b, b_rate;
};
Arguments arguments(const Model& model, MachineSystem& system, State state,
                    const std::vector<const Element*>& elements) {
  const Eigen::Index n = model.freedoms, m = std::ssize(elements);
  Arguments out{MatrixXd::Zero(m, n), MatrixXd::Zero(m, n)};
  const auto rates = [&](const State& at) {
    system.residual(at);
    VectorXd v(m);
    for (Eigen::Index i = 0; i < m; ++i)
      v[i] = argument(*elements[static_cast<std::size_t>(i)], system.links()).v;
    return v;
  };
  const VectorXd u = state.u, q = state.q;
  state.u.setZero();
  const VectorXd driven = rates(state);
  for (Eigen::Index j = 0; j < n; ++j) {
    state.u[j] = 1;
    out.b.col(j) = rates(state) - driven;
    state.u[j] = 0;
  }
  if (u.isZero(0) && driven.isZero(0)) return out;
  state.u = u;
  VectorXd x = VectorXd::Zero(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double e = 1e-5 * model.scale[j];
    for (const double side : {-1., 1.}) {
      x[j] = side * e;
      system.move(q, x, state.q);
      out.b_rate.col(j) += side / (2 * e) * rates(state);
    }
    x[j] = 0;
  }
  return out;
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

// The states' part of the matrix of the first-order system in x, v, z (all three relative to their scales).
// Returns the number of their constants.
int add_states(const Model& model, MachineSystem& system, const State& state, const MatrixXd& N,
               const Eigen::LLT<MatrixXd>& mass, double w, MatrixXd& A) {
  const Eigen::Index m = N.cols();
  std::vector<const Element*> elements;
  for (const Element* e : forces_of<Element>(model))
    if (e->states > 0) elements.push_back(e);
  const Arguments by = arguments(model, system, state, elements);
  const MatrixXd to_coordinates = model.scale.asDiagonal() * N;
  const MatrixXd b = by.b * to_coordinates, b_rate = by.b_rate * to_coordinates;
  system.residual(state);
  int constants = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Element& e = *elements[i];
    const auto row = static_cast<Eigen::Index>(i);
    const ElementArgument x = argument(e, system.links());
    const ElementDerivatives d = derivatives(e, model, state, x.s, x.v);
    constants += d.constants;
    const VectorXd push = mass.solve(b.row(row).transpose()) / w;
    for (int k = 0; k < e.states; ++k) {
      const Eigen::Index z = 2 * m + e.state + k;
      const double scale = model.state_scale[e.state + k];
      A.block(m, z, m, 1) = d.f_z[k] * scale * push;
      A.block(z, 0, 1, m) = (d.g_s[k] * b.row(row) + d.g_v[k] * b_rate.row(row)) / scale;
      A.block(z, m, 1, m) = d.g_v[k] * w / scale * b.row(row);
      for (int j = 0; j < e.states; ++j)
        A(z, 2 * m + e.state + j) = d.g_z(k, j) * model.state_scale[e.state + j] / scale;
    }
  }
  return constants;
}

// Below that, the motion of the freedoms is the round-off of a mode of the states alone.
void normalise(Mode& mode) {
  constexpr double noise_of_roots = 1e-10;
  const auto widest = [](const Eigen::VectorXcd& v) {
    Eigen::Index i = 0;
    if (v.size() > 0) v.cwiseAbs().maxCoeff(&i);
    return v.size() > 0 ? v[i] : 0.;
  };
  const std::complex<double> freedom = widest(mode.shape), state = widest(mode.states);
  const bool moves = std::abs(freedom) > noise_of_roots * std::abs(state);
  if (!moves) mode.shape.setZero();
  mode.shape /= moves ? freedom : state;
  mode.states /= moves ? freedom : state;
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

  // x' = w v, v' = -M^-1 (K x / w + C v - sum b^T f_z z / w), z' = g_s b x + g_v b w v + g_z z, with w so
  // that the entries are of one size.
  const MatrixXd stiffness = cholesky.solve(K);
  const double w = std::sqrt(std::max(stiffness.cwiseAbs().maxCoeff(), 1.));
  const Eigen::Index states = state.z.size(), all = 2 * m + states;
  MatrixXd A = MatrixXd::Zero(all, all);
  A.block(0, m, m, m).diagonal().setConstant(w);
  A.block(m, 0, m, m) = -stiffness / w;
  A.block(m, m, m, m) = -cholesky.solve(C);
  if (states > 0) result.constants = add_states(model, system, state, N, cholesky, w, A);
  const Eigen::EigenSolver<MatrixXd> solver(A);
  if (solver.info() != Eigen::Success)
    throw Error(ErrorCode::numerics, "the eigenvalues of the machine were not found", "mbd_server",
                "check its masses and stiffnesses for extreme values");
  const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  // s = 0 is a double root where neither spring nor damper acts: round-off e makes it sqrt(e).
  const double zero = 1e-7 * largest;
  int at_zero = 0;
  for (Eigen::Index i = 0; i < all; ++i) {
    const std::complex<double> s = solver.eigenvalues()[i];
    if (std::abs(s) <= zero) {
      ++at_zero;
      continue;
    }
    if (s.imag() < 0) continue;
    Mode mode{.s = s,
              .shape = N * solver.eigenvectors().col(i).head(m),
              .states = solver.eigenvectors().col(i).tail(states)};
    normalise(mode);
    result.modes.push_back(std::move(mode));
  }
  std::sort(result.modes.begin(), result.modes.end(),
            [](const Mode& a, const Mode& b) { return std::abs(a.s) < std::abs(b.s); });
  result.neutral = std::max(0, at_zero - result.constants + 1) / 2;
  return result;
}

}  // namespace tandem::mbd
