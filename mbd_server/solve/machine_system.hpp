// The multibody system in the form that the integrator needs.
#pragma once

#include "mbd_server/solve/articulated_body.hpp"
#include "mbd_server/solve/dynamics.hpp"
#include "mbd_server/solve/elimination.hpp"

namespace tandem::mbd {

class MachineSystem final : public System {
 public:
  explicit MachineSystem(const Model& model)
      : model_(model),
        dynamics_(model),
        elimination_(model),
        articulated_(model),
        driven_(VectorXd::Zero(std::ssize(model.motions))) {}

  Eigen::Index constraints() const override { return model_.equations; }
  const VectorXd& residual(const State& state) override {
    if (!model_.stictions.empty()) find_stuck(state);
    return dynamics_.residual(state);
  }
  const VectorXd& constraint(Level level) const override { return dynamics_.constraint(level); }
  const VectorXd& acceleration(const State& state) override;
  bool rate_jump(const State& before, const State& after, VectorXd& r, VectorXd& c) override;
  void move(const VectorXd& q0, const VectorXd& x, VectorXd& q1) const override;
  void difference(const VectorXd& q0, const VectorXd& q1, VectorXd& x) const override;
  bool increment_rate(const VectorXd& x, const VectorXd& u, VectorXd& rate) const override;
  // Coordinates that stick at the state of the last residual() are locked.
  void factorise(const MatrixWeights& weights, const VectorXd& x) override {
    factorise(weights, x, stuck_.empty() ? nullptr : &stuck_);
  }
  // `locked`: first freedoms of joints that do not move.
  void factorise(const MatrixWeights& weights, const VectorXd& x, const std::vector<int>* locked);
  void solve(const VectorXd& r, const VectorXd& c, VectorXd& dx, VectorXd& dlambda) override {
    elimination_.solve(r, c, dx, dlambda);
  }
  void shrink(VectorXd& lambda) override { elimination_.shrink(lambda); }
  double norm(const VectorXd& dx) const override;
  bool is_fine(const VectorXd& dx) const override { return dynamics_.is_fine(dx); }
  const VectorXd& states() const override { return dynamics_.states(); }
  const VectorXd& state_rates() const override { return dynamics_.state_rates(); }
  double state_norm(const VectorXd& dz) const override;
  std::string worst_state(const VectorXd& dz) const override;
  double unseen(const State& begin, const State& end) const override;
  std::string obstacle() const override;
  // Curvature of the path of all coordinates at the state of the last residual(), in rad and relative to
  // their scales [1/rad].
  double curvature(const State& state) const;
  std::string worst(const VectorXd& dx) const override;

  // At the last residual().
  const std::vector<LinkMotion>& links() const { return dynamics_.links(); }
  const std::vector<EquationValue>& equations() const { return dynamics_.equations(); }
  const Vector6d& transmitted(LinkIndex i) const { return dynamics_.transmitted(i); }
  const VectorXd& last_residual() const { return dynamics_.last_residual(); }
  double kinetic_energy() const { return dynamics_.kinetic_energy(); }

  // Equations that the last factorise() found to depend on others.
  const std::vector<int>& dependent() const { return elimination_.dependent(); }
  // Rank and null space of the constraints by geometry alone, see Elimination::factorise_geometry().
  Elimination& elimination() { return elimination_; }
  const Elimination& elimination() const { return elimination_; }
  void factorise_geometry(double independent, const std::vector<bool>& left_out) {
    elimination_.factorise_geometry(dynamics_, independent, left_out);
  }

 private:
  void find_stuck(const State& state);
  void expect_regular(Eigen::Index singular) const;

  const Model& model_;
  Dynamics dynamics_;
  Elimination elimination_;
  ArticulatedBody articulated_;
  std::vector<int> stuck_;  // freedoms that stick
  VectorXd driven_;         // change of the prescribed rates (motions)
};

}  // namespace tandem::mbd
