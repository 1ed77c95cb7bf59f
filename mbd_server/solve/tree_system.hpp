// The multibody tree as the integrator sees it.
#pragma once

#include "mbd_server/solve/linear_solver.hpp"
#include "mbd_server/solve/tree_dynamics.hpp"

namespace tandem::mbd {

class TreeSystem final : public System {
 public:
  explicit TreeSystem(const Model& model) : model_(model), dynamics_(model), solver_(model.freedoms) {}

  const VectorXd& residual(const State& state) override { return dynamics_.residual(state); }
  void move(const VectorXd& q0, const VectorXd& x, VectorXd& q1) const override;
  void factorise(const MatrixWeights& weights, const VectorXd& x) override;
  void solve(const VectorXd& r, VectorXd& dx) const override { solver_.solve(r, dx); }
  double norm(const VectorXd& dx) const override;
  std::string worst(const VectorXd& dx) const override;

  // Kinematics of the last residual().
  const std::vector<LinkMotion>& links() const { return dynamics_.links(); }

 private:
  const Model& model_;
  TreeDynamics dynamics_;
  LinearSolver solver_;
};

}  // namespace tandem::mbd
