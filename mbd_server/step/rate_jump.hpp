// Where prescribed rates jump, the other rates jump as well: M du + G^T Lambda = -M_fd dU, G du = -G_d dU,
// with the impulses Lambda of the constraints.
#pragma once

#include "mbd_server/state/system.hpp"

namespace tandem::mbd {

class RateJump {
 public:
  RateJump(const System& system, const State& state)
      : r_(VectorXd::Zero(state.u.size())),
        du_(r_),
        c_(VectorXd::Zero(system.constraints())),
        impulses_(c_) {}

  // Changes the rates of `state`; `before` is the state without the jump. Returns whether any rate jumps.
  bool apply(System& system, const State& before, State& state) {
    if (!system.rate_jump(before, state, r_, c_)) return false;
    du_.setZero();
    system.factorise({.mass = 1, .damping = 0, .stiffness = 0}, du_);
    system.solve(r_, c_, du_, impulses_);
    state.u -= du_;
    return true;
  }

 private:
  VectorXd r_, du_;        // (freedoms)
  VectorXd c_, impulses_;  // (constraints)
};

}  // namespace tandem::mbd
