// What the integrator knows of the system that it integrates: an implicit equation of second order
//   r(t, q, u, u') = 0,   q' = q u,
// on a Lie group, with increments q1 = q0 o exp(x). No word of bodies.
#pragma once

#include <Eigen/Core>
#include <string>

#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

// What multiplies dr/du', dr/du and dr/dx in the iteration matrix.
struct MatrixWeights {
  double mass = 1, damping = 0, stiffness = 0;
};

class System {
 public:
  virtual ~System() = default;

  virtual const VectorXd& residual(const State& state) = 0;
  // q1 = q0 o exp(x)
  virtual void move(const VectorXd& q0, const VectorXd& x, VectorXd& q1) const = 0;
  // Factorises the weighted sum of derivatives at the state of the last residual(), reached by the increment
  // x. Throws Error{numerics} where it is singular.
  virtual void factorise(const MatrixWeights& weights, const VectorXd& x) = 0;
  // dx = (factorised matrix)^-1 r
  virtual void solve(const VectorXd& r, VectorXd& dx) const = 0;
  // Size of an increment, each coordinate relative to its scale [-].
  virtual double norm(const VectorXd& dx) const = 0;
  // The coordinate in which the increment is largest, in the user's words.
  virtual std::string worst(const VectorXd& dx) const = 0;
};

}  // namespace tandem::mbd
