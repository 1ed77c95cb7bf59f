#include "mbd_server/step/generalized_alpha.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {

GeneralizedAlphaConstants::GeneralizedAlphaConstants(double rho)
    : alpha_m((2 * rho - 1) / (rho + 1)),
      alpha_f(rho / (rho + 1)),
      gamma(0.5 + alpha_f - alpha_m),
      beta((gamma + 0.5) * (gamma + 0.5) / 4) {}

GeneralizedAlpha::GeneralizedAlpha(double rho_inf, const NewtonSettings& newton, Eigen::Index size)
    : c_(rho_inf), newton_(newton), x_(VectorXd::Zero(size)), dx_(VectorXd::Zero(size)) {}

// r is linear in u', so that one iteration is exact.
void GeneralizedAlpha::solve_acceleration(System& system, State& state) {
  const VectorXd& r = system.residual(state);
  x_.setZero();
  system.factorise({.mass = 1, .damping = 0, .stiffness = 0}, x_);
  ++counters_.factorisations;
  system.solve(r, dx_);
  state.udot -= dx_;
}

void GeneralizedAlpha::start(System& system, State& state, double h) {
  state.udot.setZero();
  solve_acceleration(system, state);

  // Rate of u' along the motion, by a difference: an error of first order in h is enough, and this one is
  // 1e-3 of it.
  State ahead = state;
  const double dt = 1e-3 * h;
  ahead.time += dt;
  ahead.u += dt * state.udot;
  const VectorXd x = dt * state.u + 0.5 * dt * dt * state.udot;
  system.move(state.q, x, ahead.q);
  solve_acceleration(system, ahead);
  state.a = state.udot + (c_.alpha_m - c_.alpha_f) * h / dt * (ahead.udot - state.udot);
  state.step = h;
}

// a keeps its distance to u', which is due to the smooth part of the motion, and moves by the jump of u'. A
// body under a load that is constant in each window so gains exactly load * time, and stiff parts go on being
// damped: a restart with a = u' at each jump would turn the method into Newmark's, of first order.
void GeneralizedAlpha::jump(System& system, State& state) {
  solve_acceleration(system, state);
  state.a -= dx_;
  ++counters_.load_jumps;
}

void GeneralizedAlpha::step(System& system, State& state, double h) {
  recentre(state, h);
  q0_ = state.q, u0_ = state.u, udot0_ = state.udot, a0_ = state.a;

  predict(system, state, h);
  correct(system, state, h);
  state.a = ((1 - c_.alpha_f) * state.udot + c_.alpha_f * udot0_ - c_.alpha_m * a0_) / (1 - c_.alpha_m);
  ++state.steps;
  ++counters_.steps;
}

// a stands for the time t + (alpha_m - alpha_f) h: when h changes, so does its distance to u'.
void GeneralizedAlpha::recentre(State& state, double h) const {
  if (h != state.step && state.step > 0) state.a = state.udot + (h / state.step) * (state.a - state.udot);
  state.step = h;
}

// u1' = u0'
void GeneralizedAlpha::predict(System& system, State& state, double h) {
  state.a = (udot0_ - c_.alpha_m * a0_) / (1 - c_.alpha_m);
  x_ = h * u0_ + h * h * ((0.5 - c_.beta) * a0_ + c_.beta * state.a);
  state.u = u0_ + h * ((1 - c_.gamma) * a0_ + c_.gamma * state.a);
  state.time += h;
  system.move(q0_, x_, state.q);
}

// Newton's method for x. The matrix of the first iteration is kept as long as it contracts well; it is never
// kept from one step to the next, so that a step depends on nothing but the state.
void GeneralizedAlpha::correct(System& system, State& state, double h) {
  const MatrixWeights weights{.mass = (1 - c_.alpha_m) / (h * h * c_.beta * (1 - c_.alpha_f)),
                              .damping = c_.gamma / (h * c_.beta),
                              .stiffness = 1};
  double last = 0, norm = 0;
  for (int iteration = 0; iteration < newton_.max_iterations; ++iteration) {
    const VectorXd& r = system.residual(state);
    if (iteration == 0 || (iteration > 1 && norm > 0.1 * last)) {
      system.factorise(weights, x_);
      ++counters_.factorisations;
    }
    system.solve(r, dx_);
    ++counters_.newton_iterations;

    x_ -= dx_;
    state.u -= weights.damping * dx_;
    state.udot -= weights.mass * dx_;
    system.move(q0_, x_, state.q);

    last = norm;
    norm = system.norm(dx_);
    if (norm <= newton_.tolerance) return;
    if (!std::isfinite(norm)) break;
  }
  give_up(system, state, h, norm);
}

void GeneralizedAlpha::give_up(const System& system, const State& state, double h, double norm) const {
  throw Error(
      ErrorCode::numerics,
      fmt::format(
          "Newton's method did not converge in {} iterations at t = {:.9g} s with a step of {:.3g} s; the "
          "last correction is {:.3g} (tolerance {:.3g}), largest at {}",
          newton_.max_iterations, state.time, h, norm, newton_.tolerance, system.worst(dx_)),
      "mbd_server",
      fmt::format("try mbd.integrator.step = {:.3g} or less; check mass, inertia, stiffness and motion there",
                  h / 4));
}

}  // namespace tandem::mbd
