// The explicit Runge-Kutta method of order 5 with an embedded one of order 4 [Dormand1980], on a Lie group
// [MuntheKaas1998]. Each stage solves for the increment x of the configuration, in a vector space:
//
//   q = q0 o exp(x),  x' = T(x)^-1 u,  u' = a(t, q, u, z),  z' = g(t, q, u, z)
//
// with T the tangent operator of exp, the identity for all joints but spherical ones. a is
// System::acceleration(): no matrix is factorised and nothing is iterated. The last stage is at the end of
// the step, so that the next step begins with its accelerations: six evaluations a step.
//
// For systems without constraints. Where a part is stiff, stability and not accuracy limits the step, to
// about 3 of its time constants; counters().stiff says how often ([Hairer1996], IV.2).
#pragma once

#include <Eigen/Core>

#include "mbd_server/step/controlled_method.hpp"
#include "mbd_server/step/rate_jump.hpp"

namespace tandem::mbd {

class DormandPrince final : public ControlledMethod {
 public:
  DormandPrince(const System& system, const State& state);

  void start(System& system, State& state, double h) override;
  void jump(System& system, State& state) override;
  void jump(System& system, const State& before, State& state) override;
  // Throws Error{numerics} where the step is impossible.
  void step(System& system, State& state, double h) override;

  // A step is impossible where a force or an acceleration cannot be computed, or where a spherical joint
  // turns by more than half a turn.
  std::optional<LocalError> try_step(System& system, State& state, double h) override;
  void undo(State& state) const override { state = begin_; }
  [[noreturn]] void give_up(const System& system, double h) const override;
  std::string largest_position_error(const System& system) const override { return system.worst(dx_); }
  std::string largest_velocity_error(const System& system) const override { return system.worst(du_); }
  std::string largest_state_error(const System& system) const override { return system.worst_state(dz_); }
  ControlTraits traits() const override;

 private:
  static constexpr int stages = 7;

  void evaluate(System& system, State& state);
  bool take(System& system, const State& state, double h);
  bool limited_by_stability(const System& system, double h);

  RateJump rate_jump_;
  State begin_, stage_;                // at the begin of the step; at a stage
  VectorXd x_;                         // increment to the stage (freedoms)
  VectorXd last_x_, last_u_, last_z_;  // of the last stage but one
  Eigen::MatrixXd x_rates_, u_rates_;  // x' and u' (freedoms x stages)
  Eigen::MatrixXd z_rates_;            // z' (first-order states x stages)
  VectorXd rate_, dx_, du_;            // x' of a stage; errors of x and u (freedoms)
  VectorXd dz_;                        // error of z (first-order states)
  double failed_at_ = 0;               // [s]
  std::string failure_;                // of the last try_step() that failed
};

}  // namespace tandem::mbd
