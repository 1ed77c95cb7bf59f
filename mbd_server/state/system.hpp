// The interface by which the integrator uses a system: an implicit equation of second order with constraints,
//   r(t, q, u, u', lambda, z) = 0,   q' = q u,   phi(t, q) = 0,   z' = g(t, q, u, z),
// on a Lie group, with increments q1 = q0 o exp(x); r depends on the multipliers as G^T lambda, G = d phi / d
// x. The interface does not refer to bodies. A system without constraints has no multipliers.
//
// The states of first order are condensed: the system solves the equation for them that State::z_weight
// describes whenever it evaluates the residual, and its iteration matrix contains their change with q and u.
#pragma once

#include <Eigen/Core>
#include <string>

#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

// Weights of dr/du', dr/du and dr/dx in the iteration matrix A.
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
  // The u' that solves r = 0, of a system without constraints. It does not depend on state.udot but for
  // round-off. Afterwards, residual() must be called before anything else that refers to its state.
  virtual const VectorXd& acceleration(const State& state) = 0;
  // The first-order states z and their rates g at the last residual() or acceleration(); not used where there
  // are none.
  virtual const VectorXd& states() const { return no_states(); }
  virtual const VectorXd& state_rates() const { return no_states(); }
  // Size of a change of these states, each relative to its scale [-]; and the one that changes most, in the
  // user's words.
  virtual double state_norm(const VectorXd&) const { return 0; }
  virtual std::string worst_state(const VectorXd&) const { return {}; }
  // Whether prescribed rates differ between two states of the same time and configuration. If so, r and c
  // are the changes of the residual and of the second derivative of phi when the change dU of these rates
  // is added to the prescribed accelerations: M_fd dU and G_d dU, that is, the impulse of the change and
  // the violation of the rates by it.
  virtual bool rate_jump(const State& before, const State& after, VectorXd& r, VectorXd& c) = 0;
  // q1 = q0 o exp(x)
  virtual void move(const VectorXd& q0, const VectorXd& x, VectorXd& q1) const = 0;
  // The shortest x with q1 = q0 o exp(x).
  virtual void difference(const VectorXd& q0, const VectorXd& q1, VectorXd& x) const = 0;
  // The rate of x in q = q0 o exp(x), where q moves with u. Returns false where x turns a joint by more than
  // half a turn, so that its rate would lose its meaning.
  virtual bool increment_rate(const VectorXd& x, const VectorXd& u, VectorXd& rate) const = 0;
  // Factorises [A, G^T; G, 0] at the state of the last residual(), which the increment x has reached.
  // Throws Error{numerics} where A is singular; dependent rows of G are left out.
  virtual void factorise(const MatrixWeights& weights, const VectorXd& x) = 0;
  // [dx; dlambda] = [A, G^T; G, 0]^-1 [r; c]
  virtual void solve(const VectorXd& r, const VectorXd& c, VectorXd& dx, VectorXd& dlambda) = 0;
  // Replaces lambda by the smallest multipliers with the same forces, at the last factorise().
  virtual void shrink(VectorXd& lambda) = 0;
  // Size of an increment, each coordinate relative to its scale [-].
  virtual double norm(const VectorXd& dx) const = 0;
  // Whether the forces hardly change with an increment that norm() finds small: a root of Newton's method is
  // one where this holds as well.
  virtual bool is_fine(const VectorXd&) const { return true; }
  // What forces over a coordinate do between two states that neither of them sees: the largest deviation from
  // a straight line, as a share of the range of the force [-].
  virtual double unseen(const State&, const State&) const { return 0; }
  // The coordinate with the largest increment, in the user's words.
  virtual std::string worst(const VectorXd& dx) const = 0;
  // A possible reason, at the last factorise(), why Newton's method does not converge, in the user's words;
  // empty: none is known.
  virtual std::string obstacle() const { return {}; }

 private:
  static const VectorXd& no_states() {
    static const VectorXd empty;
    return empty;
  }
};

}  // namespace tandem::mbd
