// The error of a run, measured by running the machine twice more with longer steps.
#include "mbd_server/coupling/mbd_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "mbd_server/model/machines.hpp"

namespace tandem::mbd {
namespace {

constexpr const char* where_to_go = "; tandem run --estimate richardson measures it";
constexpr double fewest_steps = 16;  // of a run whose error can be measured
// Coordinates that move by less than these shares, of their scale and of what the one that moves most in
// their machine does, are judged as if they moved by it: the deflection of stiff parts.
struct Floor {
  double motion, widest;
};
constexpr Floor floor_of_machine{1e-6, 1e-3};
// In machines with stops or shapes of contact, which may rest there, of what moves most in the scene.
constexpr Floor floor_at_rest{1e-4, 0.01};

// Whether a machine, by its first link, has stops or shapes of contact (links).
std::vector<bool> machines_that_rest(const Model& model, const std::vector<int>& machine) {
  std::vector<bool> rests(model.links.size(), false);
  const auto note = [&](LinkIndex link) {
    if (link > 0) rests[static_cast<std::size_t>(machine[static_cast<std::size_t>(link)])] = true;
  };
  for (const int stop : model.stops) note(model.joint_forces[static_cast<std::size_t>(stop)].link);
  for (const ContactShape& shape : model.contact.shapes) note(shape.link);
  return rests;
}

}  // namespace

// Returns why the error cannot be measured by simulating the machine alone once more; empty where it can.
std::string MbdSolver::obstacle_to_estimate() {
  if (loaded_) return "loads of particles or a controller act";
  if (control_)
    return fmt::format("the error control took {} steps with local errors of up to {:g} each", state_.steps,
                       control_->tolerance());
  if (machine_->extrapolation) return "the error of second order is extrapolated" + difference_of_runs();
  if (resumed_) return "the run was continued from a file";
  if (machine_->contacts.counters().contacts > 0) return "joints meet their stops";
  if (!machine_->model.contact.empty()) return "bodies touch each other";
  if (machine_->stiction.counters().stuck + machine_->stiction.counters().broken_away > 0)
    return "joints stick and slide";
  if (machine_->method.shortened().count > 0) return "steps were taken in parts";
  if (nominal_steps() < fewest_steps) return "there are too few steps";
  return {};
}

// The longest steps that the run was to take.
double MbdSolver::nominal_steps() const {
  return std::min(state_.time / nominal_step_, static_cast<double>(state_.steps));
}

void MbdSolver::record_travel() {
  machine_->system.difference(machine_->state.q, state_.q, moved_);
  for (std::size_t i = 0; i < totals_.least.size(); ++i) {
    const double x = moved_[static_cast<Eigen::Index>(i)];
    totals_.least[i] = std::min(totals_.least[i], x);
    totals_.most[i] = std::max(totals_.most[i], x);
  }
}

// How far each coordinate has moved, the three of a ball joint or of a translation together; not more than
// its scale, 1 rad or the size of all machines. An error of a coordinate is judged against this.
VectorXd MbdSolver::reach() const {
  const Model& model = machine_->model;
  VectorXd reach(model.freedoms);
  const std::vector<int> machine = machine_of_links(model);
  const std::vector<bool> rests = machines_that_rest(model, machine);
  std::vector<double> widest(model.links.size(), 0);  // of the machine that begins with that link [-]
  const auto for_each_joint = [&](auto&& f) {
    for (std::size_t i = 1; i < model.links.size(); ++i) {
      const Link& link = model.links[i];
      if (link.u != none)
        f(link, static_cast<std::size_t>(machine[i]), reach.segment(link.u, freedoms(link.kind)));
    }
  };
  for_each_joint([&](const Link& link, std::size_t of, auto segment) {
    double most = 0;
    for (int k = link.u; k < link.u + freedoms(link.kind); ++k)
      most = std::max(most,
                      totals_.most[static_cast<std::size_t>(k)] - totals_.least[static_cast<std::size_t>(k)]);
    const double scale = model.scale[link.u];
    segment.setConstant(std::min(most, scale));
    widest[of] = std::max(widest[of], std::min(most / scale, 1.0));
  });
  const double widest_of_all = *std::max_element(widest.begin(), widest.end());
  for_each_joint([&](const Link& link, std::size_t of, auto segment) {
    const Floor& floor = rests[of] ? floor_at_rest : floor_of_machine;
    segment =
        segment.cwiseMax(model.scale[link.u] *
                         std::max(floor.motion, floor.widest * (rests[of] ? widest_of_all : widest[of])));
  });
  return reach;
}

// Sums of local errors, relative to the reach of their coordinates: the largest.
double MbdSolver::largest_share(const std::vector<double>& errors) const {
  if (errors.empty()) return 0;
  return Eigen::Map<const VectorXd>(errors.data(), moved_.size()).cwiseQuotient(reach()).maxCoeff();
}

double MbdSolver::local_error_sum() const {
  return largest_share(totals_.local_errors);
}

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

// Repeats the motion from the start without particle loads, in about `steps` steps. Returns none where these
// steps are too long.
std::optional<RunEnd> MbdSolver::run_again(double end, double steps) {
  Machine& m = *machine_;
  const Window window{0, {}, to_nanoseconds(end)};
  step_ = end / steps;
  state_ = m.state;
  totals_.cubed_steps = 0;
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

// How far the two runs of an extrapolation are from each other, and where most, as a share of the reach.
MbdSolver::Difference MbdSolver::spread_of_extrapolation() {
  if (!machine_->extrapolation || machine_->model.freedoms == 0) return {};
  const Eigen::Index n = state_.q.size();
  machine_->system.difference(state_.coarse.head(n), state_.fine.head(n), moved_);
  Difference difference;
  difference.share = moved_.cwiseQuotient(reach()).cwiseAbs().maxCoeff(&difference.coordinate);
  return difference;
}

// The error of the extrapolated motion is the smaller, the smaller this difference is.
std::string MbdSolver::difference_of_runs() {
  const Difference d = spread_of_extrapolation();
  if (d.coordinate < 0) return {};
  return fmt::format(" (its two runs differ by {:.2g} of how far {} moves)", d.share,
                     machine_->model.coordinate_names[static_cast<std::size_t>(d.coordinate)]);
}

// What a run tells of its error on the way: extrapolation the error of the finer of its two runs, which is
// larger than that of the result, and error control the sum of its local errors where it is large. Where it
// is small, it says less than the errors of the velocity do, which last.
std::optional<double> MbdSolver::error_of_the_way() {
  if (machine_->model.freedoms == 0) return {};
  if (machine_->extrapolation) return spread_of_extrapolation().share / 3;
  constexpr double large = 0.01;
  if (!control_ || !sums_local_errors() || local_error_sum() < large) return {};
  return local_error_sum();
}

// Two runs, with steps that are `factor` and twice `factor` times as long, which may take that share of the
// iterations of the run.
void MbdSolver::compare_with_longer_steps(const RunEnd& run, const State& state, double factor, double share,
                                          ErrorEstimate& estimate) {
  const bool last = factor <= 2;
  const RunTotals totals = totals_;
  const GeneralizedAlpha method = machine_->method;
  const std::optional<double> step = step_;
  const auto iterations = static_cast<double>(method.counters().newton_iterations);
  const double steps = nominal_steps() / factor;
  const VectorXd reach = this->reach();
  budget_ = {static_cast<std::uint64_t>(iterations * (1 + share)), last};
  // The errors of these runs are at least factor^2 times as large as those of the run.
  machine_->method.loosen(factor * factor);
  std::optional<RunEnd> ends[2];
  for (int k = 0; k < 2; ++k) {
    ends[k] = run_again(state.time, steps / (k + 1));
    estimate.steps += static_cast<double>(state_.steps);
    if (!ends[k]) break;
    machine_->system.difference(state.q, state_.q, moved_);
    if (moved_.size() > 0) ends[k]->motion = moved_.cwiseQuotient(reach).cwiseAbs().maxCoeff();
  }
  state_ = state;
  totals_ = totals;
  step_ = step;
  budget_.reset();
  machine_->method = method;
  const double spent = estimate.steps;
  estimate = ends[1] ? estimate_error(run, *ends[0], *ends[1]) : ErrorEstimate{.reason = unresolved};
  if (estimate.reason == unresolved && ends[0] && last) complete_estimate(run, *ends[0], estimate);
  estimate.steps = spent;
}

// The further runs are short; where their steps do not resolve the motion, two longer ones follow.
ErrorEstimate MbdSolver::measure_error() {
  if (const std::string obstacle = obstacle_to_estimate(); !obstacle.empty())
    return {.motion = error_of_the_way(), .reason = obstacle + where_to_go};
  const RunEnd run = run_end();
  const State state = state_;
  const double cpu_begin = cpu_seconds(CpuClock::thread);
  ErrorEstimate estimate{.reason = unresolved};
  constexpr double far = 19.5, near = 2;
  if (nominal_steps() >= 10 * far) compare_with_longer_steps(run, state, far, 0.15, estimate);
  // Much longer steps may end near the right place by chance, as after whole periods of a vibration.
  const bool by_chance =
      estimate.motion.value_or(HUGE_VAL) < 0.1 * local_error_sum() && local_error_sum() > 1e-3;
  if (!estimate.reason.empty() || by_chance) compare_with_longer_steps(run, state, near, 2, estimate);
  // Steps between close breaks are as long in the further runs, which do not show their errors.
  if (estimate.motion) *estimate.motion += largest_share(totals_.short_step_errors);
  if (!estimate.reason.empty()) estimate.reason += where_to_go;
  estimate.cpu_seconds = cpu_seconds(CpuClock::thread) - cpu_begin;
  const Model& model = machine_->model;
  // Where energy is only stored, the residual of the balance is an error.
  if (!model.damped && !model.driven && !model.powered)
    estimate.energy = std::abs(energy_residual(run.energy));
  return estimate;
}

}  // namespace tandem::mbd
