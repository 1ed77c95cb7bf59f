#include "mbd_server/solve/equilibrium.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mbd_server/forces/element_force.hpp"
#include "mbd_server/solve/modes.hpp"

namespace tandem::mbd {
namespace {

class EquilibriumSearch {
 public:
  EquilibriumSearch(const Model& model, MachineSystem& system, State& state)
      : model_(model),
        system_(system),
        state_(state),
        elements_(forces_of<Element>(model)),
        zero_(VectorXd::Zero(model.freedoms)),
        way_(zero_),
        dx_(zero_),
        acceleration_(zero_),
        dlambda_(VectorXd::Zero(model.equations)) {}

  // Of equilibria to which the search has come from elsewhere, one is left that is unstable: the search goes
  // on from beside it, on the side from which it came.
  EquilibriumReport run() {
    constexpr int most = 8;
    stop();
    const VectorXd given = state_.z;
    expect_states_that_rest();
    EquilibriumReport report;
    for (int visits = 0;; ++visits) {
      begin_states();
      search(report);
      end_states();
      system_.residual(state_);
      if (visits == most || !leave_unstable()) break;
    }
    if (has_states()) {
      report.state_change = system_.state_norm(state_.z - given);
      report.changed_state = system_.worst_state(state_.z - given);
    }
    report.moved = system_.worst(way_);
    report.distance = way_.size() == 0 ? 0 : way_.cwiseQuotient(model_.scale).cwiseAbs().maxCoeff();
    return report;
  }

 private:
  void search(EquilibriumReport& report) {
    double acceleration = accelerate();
    // The first correction is of the size `longest` where it is an acceleration over mu. The weight that
    // remains for coordinates that nothing holds is far below the stiffness of a pendulum of that size.
    const double fall = std::max(model_.gravity.norm() / model_.size, 1e-6), first = acceleration / longest,
                 least = 1e-6 * fall;
    double mu = std::max({first, least, steepest_});
    for (;; ++report.iterations) {
      if (report.iterations == max_iterations) fail("was not found in 1000 iterations");
      before_ = state_;
      state_step_ = state_steps_ / std::sqrt(mu);
      if (state_step_ > longest_state_step) fail("was not found");
      const double last = acceleration, before_rest = unrest(), pushed = std::max(last, push());
      double size = HUGE_VAL;
      try {
        size = correct(mu);
        acceleration = size <= longest ? accelerate() : HUGE_VAL;
      } catch (const Error& error) {
        // A chamber has no oil there.
        if (error.code() != ErrorCode::numerics || !has_states()) throw;
        acceleration = HUGE_VAL;
      }
      // Too far, or, where a weight below a negative stiffness makes it Newton's method, uphill.
      if ((uphill_ || !(acceleration <= 2 * pushed)) && size > converged) {
        state_ = before_;
        if (has_states()) system_.residual(state_);
        acceleration = last;
        mu *= 4;
        state_steps_ /= 8;
        if (!std::isfinite(mu)) fail("was not found");
        continue;
      }
      // A step that is much longer than the error wants makes it smaller than round-off.
      if (mu <= 10 * least && unrest() > std::max(at_rest, 0.01 * before_rest)) state_steps_ *= 10;
      way_ += dx_;
      if (!(system_.norm(way_) <= farthest)) fail("was not found: the machine moves away");
      // A coordinate that nothing holds drifts by round-off: its acceleration is zero, its correction is not.
      if (mu <= least && (size <= converged || acceleration <= 1e-12 * fall) && unrest() <= at_rest) break;
      mu = std::clamp(first > 0 ? mu * acceleration / std::max(last, 1e-300) : least, least, mu);
    }
    report.acceleration = acceleration;
  }

  // From an unstable equilibrium to which the machine has moved, a twentieth of the way along the fastest
  // growing mode, towards the configuration of the scene. The weight then stays above the negative stiffness.
  bool leave_unstable() {
    constexpr int most_freedoms = 200;  // the search for the modes is dense
    constexpr double moved = 1e-9, share = 0.05;
    if (model_.freedoms > most_freedoms || !(system_.norm(way_) > moved)) return false;
    const Mode* fastest = nullptr;
    const Modes found = find_modes(model_, system_, state_);
    for (const Mode& mode : found.modes)
      if (mode.s.imag() == 0 && mode.s.real() > 1e-6 && !mode.shape.isZero(0) &&
          (!fastest || mode.s.real() > fastest->s.real()))
        fastest = &mode;
    system_.residual(state_);
    if (!fastest) return false;
    const VectorXd shape = fastest->shape.real();
    const double along = -shape.dot(way_.cwiseQuotient(model_.scale));
    if (std::abs(along) <= moved) return false;
    steepest_ = 4 * fastest->s.real() * fastest->s.real();
    dx_ = (std::copysign(share, along) * shape).cwiseProduct(model_.scale);
    before_ = state_;
    system_.move(before_.q, dx_, state_.q);
    way_ += dx_;
    return true;
  }

  static constexpr int max_iterations = 1000;
  static constexpr double longest = 0.2;      // correction of one iteration: rad, or sizes of the system
  static constexpr double farthest = 100;     // whole way: rad, or sizes of the system
  static constexpr double converged = 1e-12;  // correction of Newton's method: rad, or sizes of the system

  static constexpr double longest_state_step = 1e15;  // [s]
  static constexpr double at_rest = 1e-11;            // rates of the states, relative to their scales [1/s]

  static constexpr const char* hint =
      "hold it by a spring, a joint, a stop or a motion, or leave out mbd.start = \"equilibrium\"";

  void stop() {
    state_.u.setZero();
    state_.udot.setZero();
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      const int motion = model_.links[i].motion;
      if (motion == none) continue;
      const double rate = model_.motions[static_cast<std::size_t>(motion)].at(state_.time, state_.side).rate;
      if (rate != 0)
        throw Error(
            ErrorCode::scene,
            fmt::format("a joint is driven at {:.3g} rad/s or m/s at the start, and an equilibrium is "
                        "at rest",
                        rate),
            "mbd.start", "let its motion begin at rest, or leave out mbd.start = \"equilibrium\"");
    }
  }

  bool has_states() const { return state_.z.size() > 0; }

  void expect_states_that_rest() const {
    for (const Element* e : elements_) e->law->expect_rest(input_of(*e, model_, state_));
  }

  void begin_states() {
    if (!has_states()) return;
    system_.residual(state_);
    state_.at_rest = true;
    state_.z_weight = 0;
    for (const Element* e : elements_) {
      const StatesOfElement kept =
          e->law->kept_at_rest(argument(*e, system_.links()).s, states_of(*e, state_.z));
      for (int k = 0; k < e->states; ++k) state_.z_known[e->state + k] = kept[k];
    }
  }

  void end_states() {
    if (!has_states()) return;
    system_.residual(state_);
    state_.z = system_.states();
    state_.at_rest = false;
    state_.z_known.setZero();
  }

  // The multipliers at the end of the last iteration are those at the begin of the next.
  void keep_multipliers() {
    const VectorXd& z = system_.states();
    for (const Element* e : elements_)
      if (e->law->has_multiplier_at_rest()) state_.z_known[e->state] = z[e->state];
  }

  // Rates of the states at the last residual() [1/s]: errors of the coordinates that integrals control.
  double unrest() const { return has_states() ? system_.state_norm(system_.state_rates()) : 0; }

  // As accelerate(), with the multipliers that the present errors would have after the next step.
  double push() {
    if (unrest() == 0) return 0;
    state_.z_weight = state_step_;
    const VectorXd lambda = state_.lambda;
    const double acceleration = accelerate();
    state_.z_weight = 0;
    state_.lambda = lambda;
    return acceleration;
  }

  // Acceleration with which the machine would leave this configuration from rest, in System::norm() [1/s2];
  // the multipliers become those of that motion.
  double accelerate() {
    const VectorXd& r = system_.residual(state_);
    system_.factorise({.mass = 1, .damping = 0, .stiffness = 0}, zero_);
    system_.solve(r, system_.constraint(Level::acceleration), acceleration_, dlambda_);
    state_.lambda -= dlambda_;
    system_.shrink(state_.lambda);
    return system_.norm(acceleration_);
  }

  // The size of the correction, which is applied.
  double correct(double mu) {
    if (has_states()) state_.z_weight = state_step_;
    const VectorXd& r = system_.residual(state_);
    system_.factorise({.mass = mu, .damping = 0, .stiffness = 1}, zero_);
    system_.solve(r, system_.constraint(Level::position), dx_, dlambda_);
    dx_ = -dx_;
    // Without loops the forces at rest are -r: they do work downhill.
    uphill_ = model_.equations == 0 && !has_states() && -r.dot(dx_) < 0 && system_.norm(dx_) > 1e-8;
    state_.lambda -= dlambda_;
    system_.move(before_.q, dx_, state_.q);
    if (has_states()) {
      system_.residual(state_);
      keep_multipliers();
      state_.z_weight = 0;
    }
    return system_.norm(dx_);
  }

  [[noreturn]] void fail(const std::string& what) {
    // At this place a multiplier without an end is why.
    state_ = before_;
    state_.z_weight = 0;
    system_.residual(state_);
    if (unrest() > 1e-6) {
      const VectorXd& rates = system_.state_rates();
      throw Error(ErrorCode::scene,
                  fmt::format("an equilibrium {}: the {} grows without end, as the machine does not come "
                              "to its target",
                              what, system_.worst_state(rates)),
                  "mbd.start",
                  "give a target that it can reach, limit its torque or force (max_torque, max_force), leave "
                  "out the integral, or leave out mbd.start = \"equilibrium\"");
    }
    throw Error(ErrorCode::scene,
                fmt::format("an equilibrium {}, largest change at {}", what, system_.worst(way_)),
                "mbd.start", hint);
  }

  const Model& model_;
  MachineSystem& system_;
  State& state_;
  std::vector<const Element*> elements_;
  State before_;
  double state_step_ = 0;   // of z' = error in the next iteration [s]
  bool uphill_ = false;     // whether the last correction went against the forces
  double steepest_ = 0;     // weight above a negative stiffness [1/s2]
  double state_steps_ = 1;  // the same over 1 / sqrt(mu), the step of the motion
  VectorXd zero_, way_, dx_, acceleration_, dlambda_;
};

}  // namespace

EquilibriumReport find_equilibrium(const Model& model, MachineSystem& system, State& state) {
  return EquilibriumSearch(model, system, state).run();
}

}  // namespace tandem::mbd
