// Integration of the multibody system over one window: steps, breaks of functions of time, contacts with
// stops.
#include "mbd_server/coupling/mbd_solver.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace tandem::mbd {

// No step contains a break of a function of time: the step before a break ends there.
void MbdSolver::integrate(const Window& window) {
  const double end = to_seconds(window.end);
  double length = window.length();
  for (double stop = next_stop(end); stop < end; stop = next_stop(end)) {
    integrate_until(stop, stop - state_.time);
    cross_break();
    length = end - stop;
  }
  integrate_until(end, length);
  cross_break();
}

// The first break before `end`, or `end` where there is none.
double MbdSolver::next_stop(double end) const {
  const std::vector<double>& breaks = machine_->model.breaks;
  const double time = state_.time;
  const auto next = std::upper_bound(breaks.begin(), breaks.end(), time + time_resolution(time));
  double stop = next != breaks.end() ? *next : end;
  // Steps that are kept end at windows, as they did.
  if (again_ && between_breaks(again_->kept)) {
    const double of_window = (std::floor((time + time_resolution(time)) / window_) + 1) * window_;
    if (of_window < stop - time_resolution(stop)) stop = of_window;
  }
  return stop < end - time_resolution(end) ? stop : end;
}

// Whether the time is between two breaks that are at most so many steps apart.
bool MbdSolver::between_breaks(double steps) const {
  const std::vector<double>& breaks = machine_->model.breaks;
  const auto next =
      std::upper_bound(breaks.begin(), breaks.end(), state_.time + time_resolution(state_.time));
  return next != breaks.begin() && next != breaks.end() &&
         *next - *(next - 1) < steps * nominal_step_ * (1 + 1e-9);
}

// Forces and prescribed rates jump where the present time is a break.
void MbdSolver::cross_break() {
  const std::vector<double>& breaks = machine_->model.breaks;
  const double time = state_.time, resolution = time_resolution(time);
  const auto found = std::lower_bound(breaks.begin(), breaks.end(), time - resolution);
  if (found == breaks.end() || *found > time + resolution) {
    state_.side = time;
    return;
  }
  MachineSystem& system = machine_->system;
  predicted_ = state_;
  state_.side = time;
  const double before = system.kinetic_energy();
  for (std::size_t k = 0; k < rates_before_.size(); ++k)
    rates_before_[k] = system.links()[prescribed_[k]].coordinate.rate;
  // Time stepping finds the velocities of the end of a step anew, whatever the motions did before.
  if (!machine_->time_stepping.apply()) machine_->integrator().jump(system, predicted_, state_);
  state_.step = 0;  // what the last step tells of the motion ends here
  system.residual(state_);
  record_jump(system.kinetic_energy() - before);
  machine_->balance.begin(state_, system);
  for (std::size_t k = 0; k < before_.size(); ++k)
    before_[k] = observe_body(machine_->model, machine_->system.links(), machine_->model.boundary[k]);
}

// One step of fixed length, or its two halves.
void MbdSolver::take_step(double h, bool halved) {
  Machine& m = *machine_;
  if (halved) {
    take_step(h / 2);
    h /= 2;
  }
  if (!again_ || again_->parts)
    m.integrator().step(m.system, state_, h);
  else if (!m.method.try_step(m.system, state_, h))
    m.method.give_up(m.system, h);
  if (again_ && m.method.counters().newton_iterations > again_->iterations) m.method.give_up(m.system, h);
}

// Into how many parts to take the step of length h that has led from predicted_ to state_. A force that
// changes the rates by du while it moves the machine by dx out of its uniform motion acts upon another
// configuration: the rates are off by some du dx / 6 from the trapezoidal rule, of which the first part is,
// and by the ratio of the constants of their errors more from the method; and by a share of 1 / n^2 of that
// with n parts. In as much time as since the start, or in a hundred steps, such an error may move
// nothing by more than a thousandth of its scale. Steps of smooth motions of 1 rad are below that from some
// 60 in a period on, and after 10,000 steps from some 200 on.
int MbdSolver::parts_of_impulse(double h) {
  constexpr double lasting = 100, allowed = 1e-3, most = 1 << 12;
  const Model& model = machine_->model;
  if (model.freedoms == 0) return 1;
  machine_->system.difference(predicted_.q, state_.q, moved_);
  const auto largest = [&](const auto& x) { return x.cwiseQuotient(model.scale).cwiseAbs().maxCoeff(); };
  // With the local error of the position: a force that turns over within the step moves nothing in it.
  const double dx = largest((moved_ - h * predicted_.u).cwiseAbs() +
                            error_constant_ * h * h * (state_.udot - predicted_.udot).cwiseAbs()),
               du = std::max(largest(state_.u - predicted_.u), 2 * dx / h);
  const double acts = std::max(lasting * nominal_step_, predicted_.time);
  const double ratio = 12 * std::abs(machine_->method.constants().velocity_error_constant());
  return static_cast<int>(std::clamp(std::ceil(std::sqrt(acts * du * dx / 6 * ratio / allowed)), 1.0, most));
}

// A step of fixed length, in which contacts begin and end.
void MbdSolver::take_time_step(double h) {
  Machine& m = *machine_;
  m.time_stepping.step(state_, m.system.links(), h);
  const TimeStepAccount& account = m.time_stepping.account();
  m.method.count({},
                 {.steps = 1,
                  .newton_iterations = account.effort.iterations,
                  .factorisations = account.effort.factorisations},
                 {});
  m.touching.count({}, account.contacts);
  m.touching.set_of_islands(account.lost, account.extremes);
}

// Takes steps no longer than the requested one; `length` is the time until `end`, without the round-off of a
// difference.
void MbdSolver::integrate_until(double end, double length) {
  Machine& m = *machine_;
  using Halved = Repetition::Halved;
  between_close_breaks_ = between_breaks(4);
  between_breaks_ = between_breaks(longest_again);
  const bool kept = again_ && between_breaks(again_->kept);
  const bool halved =
      again_ && (again_->halved == Halved::all || (kept && again_->halved == Halved::between_breaks));
  const Steps steps = cut(length, kept ? again_->step : step_);
  double part = HUGE_VAL;  // longest step, once one was too long for an impulse
  const auto one_step = [&](double h) {
    if (control_) {
      h = control_->step(m.controlled(), m.system, state_, std::min(state_.time + h, end));
      measure_local_error(h);
      return h;
    }
    h /= std::max(1.0, std::ceil(h / part * (1 - 1e-9)));
    if (between_close_breaks_ && part == HUGE_VAL) {
      const ShortenedSteps shortened = m.method.shortened();
      predicted_ = state_;
      take_step(h);
      const int parts = parts_of_impulse(h);
      if (parts > 1) part = h /= parts;
      if (parts > 1 || halved) {
        state_ = predicted_;
        m.method.back(shortened);
        take_step(h, halved);
      }
    } else {
      take_step(h, halved);
    }
    measure_local_error(h);
    return h;
  };
  const Stiction::Stride free_step = std::ref(one_step);  // allocates nothing
  const auto step_with_friction = [&](double h) { return m.stiction.step(state_, h, free_step); };
  const StopContacts::Stride stride = std::ref(step_with_friction);
  const auto step_with_stops = [&](double h) { return m.contacts.step(state_, h, stride); };
  const BodyContacts::Stride stride_to_stops = std::ref(step_with_stops);
  const double energy_scale = m.model.contact.empty() ? 0 : this->energy_scale();
  const bool in_islands = m.islands.apply() && !control_ && !again_ && !m.extrapolation && !m.explicit_method;
  const auto step_of_islands = [&](double h) {
    m.islands.step(state_, m.system, h, energy_scale, m.method, m.touching);
    local_error_ = m.islands.local_errors();
    return h;
  };
  for (int i = 0; state_.time < end; ++i) {
    if (!control_ || i == 0)
      m.contacts.begin({.step = steps.length, .tolerance = control_ ? control_->tolerance() : 0});
    // The remainder of a fixed step that a contact has cut is taken as well.
    m.touching.begin(control_ ? longest_step_ : steps.length, energy_scale);
    double left = control_ ? end - state_.time : steps.length;
    do {
      double h = left;
      if (m.time_stepping.apply())
        take_time_step(h);
      else
        h = in_islands ? step_of_islands(left) : m.touching.step(state_, left, stride_to_stops);
      left -= h;
      // The end is set exactly, not as a sum of rounded steps.
      if (control_ ? end - state_.time < 1e-6 * h : i + 1 == steps.count && left <= 1e-12 * steps.length)
        state_.time = end;
      m.system.residual(state_);
      if (h > 0)
        record_step(h);
      else  // a joint began to slide, or to stick
        m.balance.begin(state_, m.system);
    } while (!control_ && left > 1e-12 * steps.length);
  }
}

// The tolerance prevents round-off from adding a step to a window that is a whole number of steps.
MbdSolver::Steps MbdSolver::cut(double length, const std::optional<double>& step) {
  const int count = step ? std::max(1, static_cast<int>(std::ceil(length / *step * (1 - 1e-9)))) : 1;
  return {count, length / count};
}

}  // namespace tandem::mbd
