#include "mbd_server/step/generalized_alpha.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {

GeneralizedAlphaConstants::GeneralizedAlphaConstants(double rho)
    : alpha_m((2 * rho - 1) / (rho + 1)),
      alpha_f(rho / (rho + 1)),
      gamma(0.5 + alpha_f - alpha_m),
      beta((gamma + 0.5) * (gamma + 0.5) / 4) {}

GeneralizedAlpha::GeneralizedAlpha(double rho_inf, const NewtonSettings& newton, const System& system,
                                   const State& state, Constraints constraints)
    : c_(rho_inf),
      newton_(newton),
      constraints_(constraints),
      rate_jump_(system, state),
      begin_(state),
      ahead_(state),
      a0_(state.a),
      x_(VectorXd::Zero(state.u.size())),
      dx_(x_),
      shift_(x_),
      phi_(VectorXd::Zero(system.constraints())),
      dlambda_(phi_),
      zero_(x_),
      w0_(state.w),
      dz_(state.w) {}

// r is linear in u' and lambda, and so is the second derivative of phi: one iteration is exact.
void GeneralizedAlpha::solve_acceleration(System& system, State& state) {
  const VectorXd& r = system.residual(state);
  x_.setZero();
  system.factorise({.mass = 1, .damping = 0, .stiffness = 0}, x_);
  ++counters_.factorisations;
  system.solve(r, system.constraint(Level::acceleration), dx_, dlambda_);
  state.udot -= dx_;
  state.lambda -= dlambda_;
  system.shrink(state.lambda);
  if (state.z.size() > 0) {
    dz_ = system.state_rates() - state.zdot;
    state.zdot = system.state_rates();
  }
}

// w keeps its difference to z' and changes by the jump of z', as a does.
void GeneralizedAlpha::jump_states(State& state) {
  if (state.z.size() > 0) state.w += dz_;
}

void GeneralizedAlpha::start(System& system, State& state, double h) {
  state.udot.setZero();
  state.lambda.setZero();
  solve_acceleration(system, state);

  // Rate of u' along the motion, by a difference: accuracy of first order in h is enough, and this
  // difference has 1e-3 of that error.
  ahead_ = state;
  const double dt = 1e-3 * h;
  ahead_.time += dt;
  ahead_.u += dt * state.udot;
  x_ = dt * state.u + 0.5 * dt * dt * state.udot;
  system.move(state.q, x_, ahead_.q);
  if (state.z.size() > 0) ahead_.z += dt * state.zdot;
  solve_acceleration(system, ahead_);
  if (state.z.size() > 0) start_states(system, state, h, dt);
  ahead_.udot = (ahead_.udot - state.udot) / dt;
  // A rate that would change u by more than u and h u' within the step belongs to a vibration that the step
  // does not resolve: it would make a useless.
  const auto too_fast = [&] {
    return h * h * system.norm(ahead_.udot) > system.norm(state.u) + h * system.norm(state.udot);
  };
  state.step = h;
  if (too_fast()) {
    // Where it is a force that rises from zero, the first step takes the rate from itself.
    ahead_ = state;
    ahead_.time += dt;
    solve_acceleration(system, ahead_);
    ahead_.udot = (ahead_.udot - state.udot) / dt;
    if (too_fast()) state.step = 0;
    ahead_.udot.setZero();
  }
  state.a = state.udot + (c_.alpha_m - c_.alpha_f) * h * ahead_.udot;
  state.udot_rate = ahead_.udot;
  if (constraints_ == Constraints::index3 && system.constraints() > 0) perturb_velocity(system, state, h);
}

// As for u': dz_ is the change of z' over dt.
void GeneralizedAlpha::start_states(System& system, State& state, double h, double dt) {
  state.zdot_rate = dz_ / dt;
  if (h * h * system.state_norm(state.zdot_rate) >
      system.state_norm(state.z) + h * system.state_norm(state.zdot))
    state.zdot_rate.setZero();
  state.w = state.zdot + (c_.alpha_m - c_.alpha_f) * h * state.zdot_rate;
}

// With phi(q1) = 0 alone, the local error of the position would cause an error of first order in the
// multipliers of the first steps. A velocity that violates its constraint by that error, G du = G l / h with
// l = error_constant h^3 u'', makes it second order [Arnold2015].
void GeneralizedAlpha::perturb_velocity(System& system, State& state, double h) {
  const VectorXd udotdot = ahead_.udot;
  ahead_ = state;
  system.residual(state);
  phi_ = system.constraint(Level::velocity);
  ahead_.u += c_.error_constant() * h * h * udotdot;
  system.residual(ahead_);
  phi_ -= system.constraint(Level::velocity);
  system.residual(state);
  x_.setZero();
  system.factorise({.mass = 1, .damping = 0, .stiffness = 0}, x_);
  system.solve(zero_, phi_, dx_, dlambda_);
  state.u -= dx_;
}

// a keeps its difference to u', which comes from the smooth part of the motion, and changes by the jump of
// u'. So a body under a load that is constant in each window gains exactly load * time, and stiff parts
// remain damped: a restart with a = u' at each jump would turn the method into Newmark's, of first order.
void GeneralizedAlpha::jump(System& system, State& state) {
  solve_acceleration(system, state);
  state.a -= dx_;
  jump_states(state);
  ++counters_.load_jumps;
}

// a changes by the effect of the forces at the time for which a stands. The momentum gained over a step is
// then that of the forces also where they are linear in time. The jump of the acceleration is dx now, and dx
// plus `shift` one step later.
void GeneralizedAlpha::jump(System& system, const State& before, State& state) {
  if (rate_jump_.apply(system, before, state)) ++counters_.factorisations;
  solve_acceleration(system, state);
  jump_states(state);
  ++counters_.load_jumps;
  if (state.step == 0) {  // the next step begins afresh
    state.a -= dx_;
    return;
  }
  ahead_ = before;
  ahead_.time += state.step;
  x_ = system.residual(ahead_);
  phi_ = system.constraint(Level::acceleration);
  if (state.z.size() > 0) w0_ = system.state_rates();
  ahead_ = state;
  ahead_.udot = before.udot;
  ahead_.lambda = before.lambda;
  ahead_.time += state.step;
  x_ = system.residual(ahead_) - x_;
  phi_ = system.constraint(Level::acceleration) - phi_;
  if (state.z.size() > 0) {
    dz_ = system.state_rates() - w0_ - dz_;
    state.w += (c_.alpha_m - c_.alpha_f) * dz_;
    state.zdot_rate += dz_ / state.step;
  }
  system.solve(x_, phi_, shift_, dlambda_);
  shift_ -= dx_;
  state.a -= dx_ + (c_.alpha_m - c_.alpha_f) * shift_;
  state.udot_rate -= shift_ / state.step;
}

// A change of the step disturbs the filtered acceleration, so that small changes are avoided.
ControlTraits GeneralizedAlpha::traits() const {
  return {.order = 3,
          .largest_factor = 2,
          .dead_band_low = 0.95,
          .dead_band_high = 1.2,
          .shortest_share = 0,
          .collapsed =
              "look for a force or motion that jumps there, or give a larger mbd.integrator.error_tolerance "
              "or a smaller mbd.integrator.min_step"};
}

void GeneralizedAlpha::step(System& system, State& state, double h) {
  error_of_parts_.reset();
  if (attempt(system, state, h)) return;
  ++counters_.rejected;
  step_in_parts(system, state, h);
}

// All decisions are made within this step: the next one starts from the state alone.
void GeneralizedAlpha::step_in_parts(System& system, State& state, double h) {
  constexpr int most = 1 << 10;  // parts
  if (shortened_.count++ == 0) {
    shortened_.first_time = state.time;
    shortened_.worst = system.worst(dx_);
    shortened_.shortest = h;
  }
  const double begin = state.time;
  error_of_parts_ = 0;
  errors_of_parts_.setZero(state.u.size());
  int length = most / 2;
  for (int done = 0; done < most;) {
    const double part = h * length / most;
    std::optional<LocalError> error = attempt(system, state, part);
    if (!error) {
      ++counters_.rejected;
      if (length > 1) {
        length /= 2;
        continue;
      }
      if (!find(system, state, part, Trust::any)) give_up(system, part);
      error = finish(system, state, part);
      ++shortened_.doubtful;
    }
    *error_of_parts_ += error->position;
    errors_of_parts_ += (std::abs(c_.error_constant()) * part * part) * dx_.cwiseAbs();
    shortened_.shortest = std::min(shortened_.shortest, part);
    done += length;
    state.time = begin + h * done / most;
    // The length doubles where a part of that length may begin.
    if (length < most / 2 && done % (2 * length) == 0) length *= 2;
  }
  state.time = begin + h;
}

std::optional<LocalError> GeneralizedAlpha::try_step(System& system, State& state, double h) {
  std::optional<LocalError> error = attempt(system, state, h);
  if (error && error->velocity > 0 && constraints_ == Constraints::index3 && system.constraints() > 0) {
    const double whole = system.norm(shift_);
    leave_out_constrained(system, state, h);
    error->velocity *= system.norm(shift_) / whole;
  }
  return error;
}

std::optional<LocalError> GeneralizedAlpha::attempt(System& system, State& state, double h) {
  state.side = state.time;
  begin_ = state;
  if (!find(system, state, h, Trust::contracting) || system.unseen(begin_, state) > largest_unseen) {
    dx_ = state.udot - begin_.udot;
    state = begin_;
    return {};
  }
  return finish(system, state, h);
}

// Newton's method starts from a constant acceleration. Stiff parts that the step does not resolve may then be
// predicted far from the root; where they are, and where the iteration does not converge, it starts from a
// constant velocity, and at last from a constant position.
bool GeneralizedAlpha::find(System& system, State& state, double h, Trust trust) {
  constexpr double far = 0.1;  // rad, or sizes of the system: beyond, other roots may be nearer
  // a stands for the time t + (alpha_m - alpha_f) h, which depends on h. Scaling a - u' by the ratio of the
  // steps would be right for smooth motions, but the part that a jump of u' has left in it would grow.
  a0_ = begin_.a;
  afresh_ = begins_afresh(h);
  if (h != begin_.step && begin_.step > 0)
    a0_ += (c_.alpha_m - c_.alpha_f) * (h - begin_.step) * begin_.udot_rate;
  if (state.z.size() > 0) predict_states(state, h);
  state.step = h;
  last_time_ = begin_.time + h;
  singular_ = false;
  for (const Begin begin : {Begin::acceleration, Begin::velocity, Begin::position}) {
    try {
      predict(system, state, h, begin);
      if (begin == Begin::acceleration) {
        dx_ = x_ - h * begin_.u;
        if (!(system.norm(dx_) <= far)) continue;
      }
      if (correct(system, state, h, trust)) return true;
      singular_ = false;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::numerics) throw;
      singular_ = true;
      failure_ = error;
    }
  }
  return false;
}

// The mean rate of u' over a short step does not hold for a long one, nor that before a break after it: a
// force that rose within the short step would go on to rise. Such a step takes the rate from itself, a0 = u'0
// + (alpha_m - alpha_f) (u'1 - u'0), which is the trapezoidal rule for u.
bool GeneralizedAlpha::begins_afresh(double h) const {
  constexpr double much = 4;  // steps in parts and those of an error control grow by 2
  // Contacts have no rate where it belongs to a vibration that the steps do not resolve.
  return h > much * begin_.step && (begin_.step == 0 || !begin_.udot_rate.isZero(0));
}

LocalError GeneralizedAlpha::finish(System& system, State& state, double h) {
  if (afresh_) a0_ = begin_.udot + (c_.alpha_m - c_.alpha_f) * (state.udot - begin_.udot);
  state.a = ((1 - c_.alpha_f) * state.udot + c_.alpha_f * begin_.udot - c_.alpha_m * a0_) / (1 - c_.alpha_m);
  ++state.steps;
  ++counters_.steps;
  dx_ = state.udot - begin_.udot;
  state.udot_rate = dx_ / h;
  // Two mean rates, over the last step and over this one, are (h + last) / 2 apart; the rate of start() is
  // an instantaneous one. After a much longer step this distance would almost cancel the effect of an
  // impact: then it is taken as h.
  shift_ = state.udot_rate - begin_.udot_rate;
  const double last = begin_.steps > 0 ? begin_.step : 0, apart = std::min(h, (h + last) / 2);
  return {std::abs(c_.error_constant()) * h * h * system.norm(dx_),
          std::abs(c_.velocity_error_constant()) * (h * h * h / apart) * system.norm(shift_),
          state.z.size() > 0 ? finish_states(system, state, h, apart) : 0};
}

// In index 3 the positions satisfy their constraints whatever the velocities do. A change of step moves u' in
// the directions of the constraints, and the velocity with it, but this error does not grow into one of the
// position: only the rest of shift_ counts. The matrix is that of the last iteration.
void GeneralizedAlpha::leave_out_constrained(System& system, State& state, double h) {
  ahead_ = state;
  system.residual(ahead_);
  phi_ = system.constraint(Level::velocity);
  ahead_.u += h * h * shift_;  // about as much as the error: forces must exist there
  system.residual(ahead_);
  phi_ = (system.constraint(Level::velocity) - phi_) / (h * h);
  system.solve(zero_, phi_, x_, dlambda_);
  shift_ -= x_;
  system.residual(state);
}

// The part of z1 that does not depend on the end of the step, and the weight of z1' in it.
void GeneralizedAlpha::predict_states(State& state, double h) {
  if (afresh_) {
    state.z_weight = 0.5 * h;
    state.z_known = begin_.z + 0.5 * h * begin_.zdot;
    return;
  }
  w0_ = begin_.w;
  if (h != begin_.step && begin_.step > 0)
    w0_ += (c_.alpha_m - c_.alpha_f) * (h - begin_.step) * begin_.zdot_rate;
  const double share = h * c_.gamma / (1 - c_.alpha_m);
  state.z_weight = share * (1 - c_.alpha_f);
  state.z_known = begin_.z + h * (1 - c_.gamma) * w0_ + share * (c_.alpha_f * begin_.zdot - c_.alpha_m * w0_);
}

// z' follows from the step, not from g: where g is stiff, its round-off is larger. Returns the local error,
// which is that of the velocity with one order less.
double GeneralizedAlpha::finish_states(System& system, State& state, double h, double apart) {
  system.residual(state);
  state.z = system.states();
  state.zdot = (state.z - state.z_known) / state.z_weight;
  state.z_weight = 0;
  if (afresh_) w0_ = begin_.zdot + (c_.alpha_m - c_.alpha_f) * (state.zdot - begin_.zdot);
  state.w = ((1 - c_.alpha_f) * state.zdot + c_.alpha_f * begin_.zdot - c_.alpha_m * w0_) / (1 - c_.alpha_m);
  state.zdot_rate = (state.zdot - begin_.zdot) / h;
  dz_ = state.zdot_rate - begin_.zdot_rate;
  return std::abs(c_.velocity_error_constant()) * (h * h * h / apart) * system.state_norm(dz_);
}

// lambda1 = lambda0 and u1' = u0', or x = h u0, or x = 0, with the rates and accelerations that belong to it.
void GeneralizedAlpha::predict(System& system, State& state, double h, Begin begin) {
  const VectorXd &u0 = begin_.u, &udot0 = begin_.udot;
  state.time = begin_.time + h;
  state.lambda = begin_.lambda;
  state.udot = udot0;
  if (afresh_) a0_ = udot0;
  state.a = (udot0 - c_.alpha_m * a0_) / (1 - c_.alpha_m);
  state.u = u0 + h * ((1 - c_.gamma) * a0_ + c_.gamma * state.a);
  x_ = h * u0 + h * h * ((0.5 - c_.beta) * a0_ + c_.beta * state.a);
  if (begin != Begin::acceleration) {
    const MatrixWeights weights = step_weights(h);
    dx_ = x_;
    if (begin == Begin::velocity) dx_ -= h * u0;
    state.u -= weights.damping * dx_;
    state.udot -= weights.mass * dx_;
    x_ -= dx_;
  }
  system.move(begin_.q, x_, state.q);
}

MatrixWeights GeneralizedAlpha::step_weights(double h) const {
  if (afresh_) {
    const double beta = c_.beta + 0.5 * (c_.alpha_m - c_.alpha_f);
    return {.mass = 1 / (h * h * beta), .damping = 1 / (2 * h * beta), .stiffness = 1};
  }
  return {.mass = (1 - c_.alpha_m) / (h * h * c_.beta * (1 - c_.alpha_f)),
          .damping = c_.gamma / (h * c_.beta),
          .stiffness = 1};
}

// Newton's method for x and lambda. The matrix of the first iteration is kept as long as the iteration
// contracts well; it is never kept from one step to the next, so that a step depends on the state only.
//
// A root is trusted where the iteration contracts from its start: at least by half from the first correction
// to the second, which use the same matrix, and monotonically after that (natural monotonicity test,
// [Deuflhard2004]). Such a root is within twice the first correction of the start.
bool GeneralizedAlpha::correct(System& system, State& state, double h, Trust trust) {
  constexpr double contraction = 0.5, in_question = 1e3;  // the latter times the tolerance
  const MatrixWeights weights = step_weights(h);
  const bool constrained = system.constraints() > 0;
  double last = 0, norm = 0;
  for (int iteration = 0; iteration < newton_.max_iterations; ++iteration) {
    const VectorXd& r = system.residual(state);
    if (iteration == 0 || (iteration > 1 && norm > 0.1 * last)) {
      system.factorise(weights, x_);
      ++counters_.factorisations;
    }
    ++counters_.newton_iterations;
    last_iterations_ = iteration + 1;
    if (constrained && constraints_ == Constraints::index2) {
      // The multipliers satisfy the constraints of the velocities, s those of the positions.
      phi_ = system.constraint(Level::velocity) / weights.damping;
      system.solve(r, phi_, dx_, dlambda_);
      state.lambda -= dlambda_;
      state.u -= weights.damping * dx_;
      state.udot -= weights.mass * dx_;
      x_ -= dx_;
      phi_ = system.constraint(Level::position) - phi_;
      system.solve(zero_, phi_, shift_, dlambda_);
      x_ -= shift_;
      dx_ += shift_;
    } else {
      system.solve(r, system.constraint(Level::position), dx_, dlambda_);
      state.lambda -= dlambda_;
      state.u -= weights.damping * dx_;
      state.udot -= weights.mass * dx_;
      x_ -= dx_;
    }
    system.move(begin_.q, x_, state.q);

    last = norm;
    norm = last_norm_ = system.norm(dx_);
    if (norm <= newton_.tolerance && system.is_fine(dx_)) {
      if (constrained) system.shrink(state.lambda);
      return true;
    }
    if (!std::isfinite(norm)) break;
    if (trust == Trust::contracting && iteration > 0 && norm > in_question * newton_.tolerance &&
        norm > (iteration == 1 ? contraction : 1) * last)
      break;
  }
  return false;
}

void GeneralizedAlpha::count(const StepCounters& before, const StepCounters& after,
                             const ShortenedSteps& shortened) {
  counters_.steps += after.steps - before.steps;
  counters_.newton_iterations += after.newton_iterations - before.newton_iterations;
  counters_.factorisations += after.factorisations - before.factorisations;
  counters_.rejected += after.rejected - before.rejected;
  if (shortened.count == 0) return;
  if (shortened_.count == 0) shortened_ = {0, 0, shortened.first_time, shortened.shortest, shortened.worst};
  shortened_.count += shortened.count;
  shortened_.doubtful += shortened.doubtful;
  shortened_.shortest = std::min(shortened_.shortest, shortened.shortest);
}

void GeneralizedAlpha::give_up(const System& system, double h) const {
  const std::string obstacle = system.obstacle();
  const std::string at = fmt::format("at t = {:.9g} s with a step of {:.3g} s", last_time_, h);
  if (singular_ && failure_)
    throw Error(ErrorCode::numerics, fmt::format("{} ({})", failure_->problem(), at), failure_->where(),
                failure_->hint());
  throw Error(
      ErrorCode::numerics,
      singular_ || !std::isfinite(last_norm_)
          ? fmt::format("Newton's method diverged {}, at {}", at, system.worst(dx_))
          : fmt::format("Newton's method did not converge in {} iterations {}; the last correction is {:.3g} "
                        "(tolerance "
                        "{:.3g}), largest at {}",
                        last_iterations_, at, last_norm_, newton_.tolerance, system.worst(dx_)),
      "mbd_server",
      obstacle.empty()
          ? fmt::format(
                "try mbd.integrator.step = {:.3g} or less; check mass, inertia, stiffness and motion there",
                h / 4)
          : obstacle);
}

}  // namespace tandem::mbd
