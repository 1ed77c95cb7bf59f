// Repetitions of a run, from which its error follows: with longer steps, with halved ones where breaks of
// functions of time cut them, and with all steps halved under the loads that acted.
#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"

namespace tandem::mbd {

RunEnd MbdSolver::run_end() {
  Machine& m = *machine_;
  m.system.residual(state_);
  RunEnd end;
  for (int b = 0; b < std::ssize(m.model.bodies); ++b)
    end.bodies.push_back(observe_body(m.model, m.system.links(), b).pose);
  end.energy = energy(m.model, state_, m.system.links());
  end.steps = static_cast<double>(state_.steps);
  end.cubed_steps = totals_.cubed_steps;
  return end;
}

// Brings back what `repeat` changes.
template <class F>
void MbdSolver::aside(F&& repeat) {
  const State state = state_;
  const RunTotals totals = totals_;
  const GeneralizedAlpha method = machine_->method;
  const std::optional<double> step = step_;
  repeat();
  state_ = state;
  totals_ = totals;
  machine_->method = method;
  step_ = step;
  again_.reset();
}

// False: Newton's method fails in the motion, or it needs more iterations than it may.
template <class F>
bool MbdSolver::goes_through(F&& motion) {
  try {
    motion();
    return true;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::numerics) throw;
    return false;
  }
}

void MbdSolver::begin_again() {
  Machine& m = *machine_;
  state_ = m.state;
  totals_.cubed_steps = 0;
  m.contacts.prepare(state_);
  m.stiction.prepare(state_);
}

// Repeats the motion from the start without particle loads, in about `steps` steps. Returns none where these
// steps are too long.
std::optional<RunEnd> MbdSolver::run_again(double end, double steps) {
  Machine& m = *machine_;
  const Window window{0, {}, to_nanoseconds(end)};
  step_ = end / steps;
  const bool done = goes_through([&] {
    begin_again();
    m.integrator().start(m.system, state_, cut(end).length);
    m.system.residual(state_);
    record_begin_motion();
    m.balance.begin(state_, m.system);
    integrate(window);
  });
  return done ? std::optional(run_end()) : std::nullopt;
}

// Adds the errors of the steps that are kept in all runs: another one takes these as halves. Where that
// fails, the sum of their local errors counts.
void MbdSolver::add_errors_between_breaks(const RunEnd& coarse, const State& coarse_end, double steps,
                                          const VectorXd& reach, double local_errors,
                                          ErrorEstimate& estimate) {
  again_->halved = Repetition::Halved::between_breaks;
  std::optional<RunEnd> halved = run_again(coarse_end.time, steps);
  estimate.steps += static_cast<double>(state_.steps);
  if (!halved) {
    *estimate.motion += local_errors;
    return;
  }
  machine_->system.difference(coarse_end.q, state_.q, moved_);
  halved->motion = moved_.size() > 0 ? moved_.cwiseQuotient(reach).cwiseAbs().maxCoeff() : 0;
  RunEnd whole = coarse;
  whole.motion = 0;
  ErrorEstimate between = estimate_error(whole, *halved, true);
  // After a pulse a machine may be near the right place by chance.
  between.motion = std::max(*between.motion, local_errors);
  const auto add = [](std::optional<double>& sum, const std::optional<double>& part) {
    if (sum && part) *sum += *part;
  };
  add(estimate.position, between.position);
  add(estimate.rotation, between.rotation);
  add(estimate.motion, between.motion);
  add(estimate.energy, between.energy);
}

// Two runs, with steps that are `factor` and twice `factor` times as long where breaks do not cut these; they
// may take that share of the iterations of the run, besides the steps that are kept.
void MbdSolver::compare_with_longer_steps(const RunEnd& run, double factor, double share,
                                          ErrorEstimate& estimate) {
  const bool last = factor <= 2;
  const auto iterations = static_cast<double>(machine_->method.counters().newton_iterations);
  const double steps = nominal_steps() / factor, time = state_.time;
  const VectorXd reach = this->reach(), end = state_.q;
  const double kept = static_cast<double>(totals_.steps_between_breaks) / static_cast<double>(state_.steps);
  share += 2 * kept;
  const double local_errors = largest_share(totals_.short_step_errors);
  double spent = estimate.steps;
  aside([&] {
    again_ = {static_cast<std::uint64_t>(iterations * (1 + share)), last, 2 * factor, step_};
    // The errors of these runs are at least factor^2 times as large as those of the run.
    machine_->method.loosen(factor * factor);
    std::optional<RunEnd> ends[2];
    State coarse;
    for (int k = 0; k < 2; ++k) {
      ends[k] = run_again(time, steps / (k + 1));
      spent += static_cast<double>(state_.steps);
      if (!ends[k]) break;
      machine_->system.difference(end, state_.q, moved_);
      if (moved_.size() > 0) ends[k]->motion = moved_.cwiseQuotient(reach).cwiseAbs().maxCoeff();
      if (k == 0) coarse = state_;
    }
    estimate = ends[1] ? estimate_error(run, *ends[0], *ends[1]) : ErrorEstimate{.reason = unresolved};
    if (estimate.reason == unresolved && ends[0] && last) complete_estimate(run, *ends[0], estimate);
    estimate.steps = spent;
    if (kept == 0 || !estimate.motion) return;
    again_->iterations += static_cast<std::uint64_t>(iterations * share);
    add_errors_between_breaks(*ends[0], coarse, steps, reach, local_errors, estimate);
  });
}

// The whole run with each step taken as two halves, under the loads and inputs that acted: those of
// particles do not follow the other motion. `motion` is the largest at the end of any window.
std::optional<ErrorEstimate> MbdSolver::compare_with_half_steps(const RunEnd& run) {
  Machine& m = *machine_;
  const VectorXd reach = this->reach();
  std::optional<ErrorEstimate> estimate;
  aside([&] {
    again_ = {.halved = Repetition::Halved::all};
    double furthest = 0;
    const bool done = goes_through([&] {
      begin_again();
      m.integrator().start(m.system, state_, cut(window_).length / 2);
      for (std::size_t k = 0; k < journal_.size(); ++k) {
        if (journal_.inputs(k, state_) != state_.inputs) {
          state_.inputs = journal_.inputs(k, state_);
          m.integrator().jump(m.system, state_);
        }
        predicted_ = state_;
        state_.load_time = state_.time;
        journal_.load(k, state_);
        jump_to_loads();
        m.system.residual(state_);
        record_begin_motion();
        m.balance.begin(state_, m.system);
        integrate(journal_.window(k));
        m.system.difference(journal_.coordinates(k, state_), state_.q, moved_);
        if (moved_.size() > 0)
          furthest = std::max(furthest, moved_.cwiseQuotient(reach).cwiseAbs().maxCoeff());
      }
    });
    if (!done) return;
    RunEnd fine = run_end();
    fine.motion = furthest;
    estimate = estimate_error(run, fine, true);
    estimate->steps = static_cast<double>(state_.steps);
  });
  return estimate;
}

}  // namespace tandem::mbd
