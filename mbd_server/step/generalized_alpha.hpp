// Implicit generalized-alpha of Chung and Hulbert (J. Appl. Mech. 60, 1993) on a Lie group (Arnold, Bruels,
// Cardona, Numer. Math. 129, 2015). With x the increment of the configuration over a step of length h,
//
//   q1 = q0 o exp(x)         x  = h u0 + h^2 (1/2 - beta) a0 + h^2 beta a1
//                            u1 = u0 + h ((1 - gamma) a0 + gamma a1)
//   r(t1, q1, u1, u1') = 0   (1 - alpha_m) a1 + alpha_m a0 = (1 - alpha_f) u1' + alpha_f u0'
//
// The equation of motion holds at the end of the step with the true acceleration u'; a is the filtered,
// algorithmic one, which stands for u' at the time t + (alpha_m - alpha_f) h. Second order, unconditionally
// stable for linear systems, and high frequencies decay by rho_inf per step.
#pragma once

#include "mbd_server/step/system.hpp"

namespace tandem::mbd {

struct GeneralizedAlphaConstants {
  double alpha_m, alpha_f, gamma, beta;
  // The optimal one-parameter family; rho_inf in [0, 1].
  explicit GeneralizedAlphaConstants(double rho_inf);
};

struct NewtonSettings {
  double tolerance = 1e-10;  // of the weighted norm of the last increment [-]
  int max_iterations = 20;
};

struct StepCounters {
  std::uint64_t steps = 0, newton_iterations = 0, factorisations = 0, load_jumps = 0;
};

class GeneralizedAlpha {
 public:
  GeneralizedAlpha(double rho_inf, const NewtonSettings& newton, Eigen::Index size);

  // Consistent start at state.q, state.u: u' solves the equation of motion, and a takes its place in time for
  // steps of length h, so that the first step is of second order already.
  void start(System& system, State& state, double h);

  // To be called when the forces jump at state.time while q and u go on: both accelerations jump with them.
  void jump(System& system, State& state);

  // One step of length h. Throws Error{numerics} when Newton's method does not converge. Does not allocate.
  void step(System& system, State& state, double h);

  const StepCounters& counters() const { return counters_; }

 private:
  void solve_acceleration(System& system, State& state);
  void recentre(State& state, double h) const;
  void predict(System& system, State& state, double h);
  void correct(System& system, State& state, double h);
  [[noreturn]] void give_up(const System& system, const State& state, double h, double norm) const;

  GeneralizedAlphaConstants c_;
  NewtonSettings newton_;
  StepCounters counters_;
  VectorXd q0_, u0_, udot0_, a0_;  // start of the step
  VectorXd x_, dx_;                // increment of the step, of the iteration (freedoms)
};

}  // namespace tandem::mbd
