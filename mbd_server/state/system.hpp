// What the integrator knows of the system that it integrates: an implicit equation of second order with
// constraints,
//   r(t, q, u, u', lambda) = 0,   q' = q u,   phi(t, q) = 0,
// on a Lie group, with increments q1 = q0 o exp(x); r depends on the multipliers as G^T lambda, G = d phi / d
// x. No word of bodies. A system without constraints has none to solve for.
#pragma once

#include <Eigen/Core>
#include <string>

#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

// What multiplies dr/du', dr/du and dr/dx in the iteration matrix A.
struct MatrixWeights {
  double mass = 1, damping = 0, stiffness = 0;
};

// phi itself, and its first and second derivative along the motion.
enum class Level { position, velocity, acceleration };

class System {
 public:
  virtual ~System() = default;

  virtual Eigen::Index constraints() const = 0;

  virtual const VectorXd& residual(const State& state) = 0;
  // At the state of the last residual().
  virtual const VectorXd& constraint(Level level) const = 0;
  // Whether prescribed rates differ between two states of one time and configuration. Then r and c are what
  // the residual and the second derivative of phi change by when the change dU of these rates is added to the
  // prescribed accelerations: M_fd dU and G_d dU, the impulse and the violation of the rates by the change.
  virtual bool rate_jump(const State& before, const State& after, VectorXd& r, VectorXd& c) = 0;
  // q1 = q0 o exp(x)
  virtual void move(const VectorXd& q0, const VectorXd& x, VectorXd& q1) const = 0;
  // The x of that, the shortest.
  virtual void difference(const VectorXd& q0, const VectorXd& q1, VectorXd& x) const = 0;
  // Factorises [A, G^T; G, 0] at the state of the last residual(), reached by the increment x. Throws
  // Error{numerics} where A is singular; dependent rows of G are left out.
  virtual void factorise(const MatrixWeights& weights, const VectorXd& x) = 0;
  // [dx; dlambda] = [A, G^T; G, 0]^-1 [r; c]
  virtual void solve(const VectorXd& r, const VectorXd& c, VectorXd& dx, VectorXd& dlambda) = 0;
  // Of all multipliers that give the same forces, the smallest. At the last factorise().
  virtual void shrink(VectorXd& lambda) = 0;
  // Size of an increment, each coordinate relative to its scale [-].
  virtual double norm(const VectorXd& dx) const = 0;
  // The coordinate in which the increment is largest, in the user's words.
  virtual std::string worst(const VectorXd& dx) const = 0;
  // What may keep Newton's method from a root at the last factorise(), in the user's words; empty: nothing is
  // known.
  virtual std::string obstacle() const { return {}; }
};

}  // namespace tandem::mbd
