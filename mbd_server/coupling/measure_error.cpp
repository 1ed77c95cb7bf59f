// What a run says of its error: which of the ways to measure it is taken, and what stands in its place.
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

// Returns why the error cannot be measured by simulating the machine once more; empty where it can.
std::string MbdSolver::obstacle_to_estimate() {
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

// The further runs are short; where their steps do not resolve the motion, two longer ones follow.
ErrorEstimate MbdSolver::measure_error() {
  // The limit of the rule that judges the sum of the local errors in place of an estimate.
  constexpr double in_doubt = 0.01;
  const std::string obstacle = obstacle_to_estimate();
  const bool doubtful = loaded_ && obstacle.empty() && local_error_sum() > in_doubt && journal_.complete();
  const std::string loads = loaded_ ? "loads of particles or a controller act" : "";
  ErrorEstimate estimate{.reason = loaded_ ? loads : obstacle};
  if (!estimate.reason.empty() && !doubtful) {
    estimate.motion = error_of_the_way();
    estimate.reason += where_to_go;
    return estimate;
  }
  const RunEnd run = run_end();
  const double cpu_begin = cpu_seconds(CpuClock::thread);
  constexpr double far = longer_again, near = 2, many = 0.1;
  // Longer steps say nothing where breaks cut them.
  const bool by_halves = loaded_ || (static_cast<double>(totals_.steps_between_breaks) >
                                         many * static_cast<double>(state_.steps) &&
                                     journal_.complete());
  if (!loaded_) estimate.reason = unresolved;
  if (by_halves) {
    if (const auto halves = compare_with_half_steps(run)) estimate = *halves;
  } else {
    if (nominal_steps() >= 10 * far) compare_with_longer_steps(run, far, 0.15, estimate);
    // Much longer steps may end near the right place by chance, as after whole periods of a vibration.
    const bool by_chance =
        estimate.motion.value_or(HUGE_VAL) < 0.1 * local_error_sum() && local_error_sum() > 1e-3;
    if (!estimate.reason.empty() || by_chance) compare_with_longer_steps(run, near, 2, estimate);
  }
  if (!estimate.reason.empty()) estimate.reason += where_to_go;
  estimate.cpu_seconds = cpu_seconds(CpuClock::thread) - cpu_begin;
  const Model& model = machine_->model;
  // Where energy is only stored, the residual of the balance is an error.
  if (!loaded_ && !model.damped && !model.driven && !model.powered)
    estimate.energy = std::abs(energy_residual(run.energy));
  return estimate;
}

}  // namespace tandem::mbd
