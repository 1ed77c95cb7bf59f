// The error of a run, measured by running the machine twice more with longer steps.
#include "mbd_server/coupling/mbd_solver.hpp"

#include <cmath>

#include "common/cpu_time.hpp"
#include "common/error.hpp"

namespace tandem::mbd {
namespace {

constexpr const char* where_to_go = "; tandem run --estimate richardson measures it";

}  // namespace

// Returns why the error cannot be measured by simulating the machine alone once more; empty where it can.
std::string MbdSolver::obstacle_to_estimate() const {
  if (loaded_) return "loads of particles or a controller act";
  if (control_) return "steps are those of the error control";
  if (machine_->extrapolation) return "the error of second order is extrapolated";
  if (resumed_) return "the run was continued from a file";
  if (machine_->contacts.counters().contacts > 0) return "joints meet their stops";
  if (!machine_->model.contact.empty()) return "bodies touch each other";
  if (machine_->stiction.counters().stuck + machine_->stiction.counters().broken_away > 0)
    return "joints stick and slide";
  if (machine_->method.shortened().count > 0) return "steps were taken in parts";
  if (steps_for_estimate(static_cast<double>(state_.steps)) < 10) return "there are too few steps";
  return {};
}

RunEnd MbdSolver::run_end() {
  Machine& m = *machine_;
  m.system.residual(state_);
  RunEnd end;
  for (int b = 0; b < std::ssize(m.model.bodies); ++b)
    end.bodies.push_back(observe_body(m.model, m.system.links(), b).pose);
  end.energy = energy(m.model, state_, m.system.links());
  end.steps = static_cast<double>(state_.steps);
  return end;
}

// Repeats the motion from the start without particle loads, in about `steps` steps. Returns none where these
// steps are too long.
std::optional<RunEnd> MbdSolver::run_again(double end, double steps) {
  Machine& m = *machine_;
  const Window window{0, {}, to_nanoseconds(end)};
  step_ = end / steps;
  state_ = m.state;
  m.contacts.prepare(state_);
  m.stiction.prepare(state_);
  try {
    m.integrator().start(m.system, state_, cut(end).length);
    m.system.residual(state_);
    record_begin_motion();
    m.balance.begin(state_, m.system);
    integrate(window);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::numerics) throw;
    return {};
  }
  return run_end();
}

ErrorEstimate MbdSolver::measure_error() {
  if (const std::string obstacle = obstacle_to_estimate(); !obstacle.empty())
    return {{}, {}, {}, obstacle + where_to_go};
  const RunEnd run = run_end();
  const State state = state_;
  const RunTotals totals = totals_;
  const GeneralizedAlpha method = machine_->method;
  const std::optional<double> step = step_;
  const std::uint64_t iterations = method.counters().newton_iterations;
  most_iterations_ = iterations + iterations * 3 / 20;
  const double steps = steps_for_estimate(run.steps), cpu_begin = cpu_seconds(CpuClock::thread);
  // The errors of these runs are at least (run.steps / steps)^2 times as large as those of the run.
  machine_->method.loosen(run.steps * run.steps / (steps * steps));
  const std::optional<RunEnd> coarse = run_again(state.time, steps);
  double taken = static_cast<double>(state_.steps);
  std::optional<RunEnd> coarser;
  if (coarse) {
    coarser = run_again(state.time, steps / 2);
    taken += static_cast<double>(state_.steps);
  }
  state_ = state;
  totals_ = totals;
  step_ = step;
  most_iterations_.reset();
  machine_->method = method;
  ErrorEstimate estimate;
  if (coarser)
    estimate = estimate_error(run, *coarse, *coarser);
  else
    estimate.reason = unresolved;
  if (!estimate.reason.empty()) estimate.reason += where_to_go;
  estimate.steps = taken;
  estimate.cpu_seconds = cpu_seconds(CpuClock::thread) - cpu_begin;
  const Model& model = machine_->model;
  // Where energy is only stored, the residual of the balance is an error.
  if (!model.damped && !model.driven && !model.powered)
    estimate.energy = std::abs(energy_residual(run.energy));
  return estimate;
}

}  // namespace tandem::mbd
