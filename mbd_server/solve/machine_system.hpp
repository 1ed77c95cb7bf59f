// The multibody system as the integrator sees it.
#pragma once

#include "mbd_server/solve/dynamics.hpp"
#include "mbd_server/solve/elimination.hpp"

namespace tandem::mbd {

class MachineSystem final : public System {
 public:
  explicit MachineSystem(const Model& model) : model_(model), dynamics_(model), elimination_(model) {}

  Eigen::Index constraints() const override { return model_.equations; }
  const VectorXd& residual(const State& state) override { return dynamics_.residual(state); }
  const VectorXd& constraint(Level level) const override { return dynamics_.constraint(level); }
  void move(const VectorXd& q0, const VectorXd& x, VectorXd& q1) const override;
  void difference(const VectorXd& q0, const VectorXd& q1, VectorXd& x) const override;
  void factorise(const MatrixWeights& weights, const VectorXd& x) override { factorise(weights, x, nullptr); }
  // `hold`: coordinates on which a large inertia is laid.
  void factorise(const MatrixWeights& weights, const VectorXd& x, const std::vector<int>* hold);
  void solve(const VectorXd& r, const VectorXd& c, VectorXd& dx, VectorXd& dlambda) override {
    elimination_.solve(r, c, dx, dlambda);
  }
  void shrink(VectorXd& lambda) override { elimination_.shrink(lambda); }
  double norm(const VectorXd& dx) const override;
  std::string worst(const VectorXd& dx) const override;

  // Of the last residual().
  const std::vector<LinkMotion>& links() const { return dynamics_.links(); }
  const std::vector<EquationValue>& equations() const { return dynamics_.equations(); }

  // Equations that the last factorise() found to depend on others.
  const std::vector<int>& dependent() const { return elimination_.dependent(); }
  void reserve_null_space(std::size_t equations) { elimination_.reserve_null_space(equations); }

 private:
  const Model& model_;
  Dynamics dynamics_;
  Elimination elimination_;
};

}  // namespace tandem::mbd
