#include "mbd_server/step/stiction.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/forces/joint_force.hpp"

namespace tandem::mbd {
namespace {

// A force above the breakaway force by no more than this share is round-off.
constexpr double round_off = 1e-9;
// An event is found within this share of the step.
constexpr double resolution = 1e-10;

}  // namespace

Stiction::Stiction(const Model& model, GeneralizedAlpha& method, System& system, const State& state)
    : model_(model), method_(method), system_(system), before_(state), held_before_(model.stictions.size()) {}

// Force that holds a sticking coordinate, over the breakaway force, less 1. The residual has no friction
// there.
double Stiction::excess(const State& state, const VectorXd& residual, int i) const {
  const double breakaway = *force(i).friction->breakaway * friction_share(force(i), model_, state),
               held = std::abs(residual[freedom(i)]);
  return breakaway > 0 ? held / breakaway - 1 : (held > 0 ? HUGE_VAL : -1);
}

void Stiction::hold(State& state, int i) const {
  const int u = freedom(i);
  state.sliding[i] = 0;
  state.u[u] = state.udot[u] = state.a[u] = state.udot_rate[u] = 0;
}

void Stiction::prepare(State& state) {
  if (model_.stictions.empty()) return;
  state.sliding.setZero(std::ssize(model_.stictions));
  for (int i = 0; i < std::ssize(model_.stictions); ++i) {
    const double rate = state.u[freedom(i)];
    if (rate != 0) state.sliding[i] = rate > 0 ? 1 : -1;
  }
  method_.jump(system_, state);
  settle(state, 0);
}

// Lets coordinates slide that the forces on them do not allow to stick, the one with the largest excess
// first, since it changes the forces on the others. A coordinate at rest whose acceleration is against its
// sliding sticks. Returns whether something changed; then the accelerations are computed anew, for steps of
// length h.
bool Stiction::settle(State& state, double h) {
  const int count = static_cast<int>(std::ssize(model_.stictions));
  bool changed = false;
  for (int change = 0; change < 4 * count + 4; ++change) {
    const VectorXd& r = system_.residual(state);
    int worst = none;
    double largest = round_off;
    for (int i = 0; i < count; ++i) {
      if (state.sliding[i] != 0) continue;
      if (const double e = excess(state, r, i); e > largest) largest = e, worst = i;
    }
    if (worst == none) break;
    state.sliding[worst] = r[freedom(worst)] > 0 ? -1 : 1;  // friction acts in the direction of r
    ++counters_.broken_away;
    changed = true;
    method_.jump(system_, state);
    for (int i = 0; i < count; ++i) {
      const int u = freedom(i);
      if (i == worst || state.sliding[i] == 0 || state.u[u] != 0 || !(state.sliding[i] * state.udot[u] < 0))
        continue;
      hold(state, i);
      ++counters_.stuck;
      method_.jump(system_, state);
    }
  }
  if (changed && h > 0) method_.start(system_, state, h);
  return changed;
}

bool Stiction::is_reversed(const State& state, int i) const {
  return state.sliding[i] * state.u[freedom(i)] < 0;
}

// Whether the step to this state contains a change; leaves the residual of the state.
bool Stiction::passes(const State& state) {
  const VectorXd& r = system_.residual(state);
  for (int i = 0; i < std::ssize(model_.stictions); ++i) {
    if (is_reversed(state, i)) return true;
    if (state.sliding[i] == 0 && excess(state, r, i) > round_off) return true;
  }
  return false;
}

// Estimates when a step of length h passes the first change, from values at both ends.
double Stiction::passed(const State& state, double h) {
  const VectorXd& r = system_.residual(state);
  double first = h;
  const auto cross = [&](double begin, double end) {
    if (begin < 0 && end > 0) first = std::min(first, h * begin / (begin - end));
  };
  for (int i = 0; i < std::ssize(model_.stictions); ++i) {
    const int u = freedom(i);
    if (state.sliding[i] != 0)
      cross(-before_.sliding[i] * before_.u[u], -state.sliding[i] * state.u[u]);
    else
      cross(held_before_[static_cast<std::size_t>(i)], excess(state, r, i));
  }
  return first;
}

double Stiction::step(State& state, double h, const Stride& stride) {
  if (model_.stictions.empty()) return stride(h);
  settle(state, h);
  before_ = state;
  {
    const VectorXd& r = system_.residual(state);
    for (int i = 0; i < std::ssize(model_.stictions); ++i)
      held_before_[static_cast<std::size_t>(i)] = state.sliding[i] == 0 ? excess(state, r, i) : 0;
  }
  double taken = stride(h);
  if (!passes(state)) return taken;

  // The interval in which the first change is: no change until `low`, one before `high`.
  double low = 0, high = taken, part = passed(state, taken);
  for (int i = 0; i < 100 && high - low > resolution * h; ++i) {
    if (!(part > low && part < high)) part = (low + high) / 2;
    state = before_;
    taken = stride(part);
    const bool beyond = passes(state);
    (beyond ? high : low) = taken;
    // The estimate from the begin of the step, moved by a little, brackets the change from both sides.
    const double next = beyond ? passed(state, taken) : (taken < part ? high : part);
    const double shift = 0.1 * resolution * h;
    part = beyond ? next - shift : std::min(high, low + std::max(2 * shift, 1e-3 * (high - low)));
    if (i % 4 == 3) part = (low + high) / 2;
  }
  if (low > 0) {
    state = before_;
    taken = stride(low);
  } else {
    state = before_;
    taken = 0;
  }
  // What changes within the resolution changes now.
  const double margin = 4 * (high - low) + resolution * h;
  bool changed = false;
  for (int i = 0; i < std::ssize(model_.stictions); ++i) {
    const int u = freedom(i);
    if (state.sliding[i] == 0) continue;
    const double left = state.sliding[i] * (state.u[u] + margin * state.udot[u]);
    if (left > 0 && !is_reversed(state, i)) continue;
    if (state.sliding[i] * state.udot[u] > 0 && !is_reversed(state, i)) continue;  // it has just begun
    hold(state, i);
    ++counters_.stuck;
    changed = true;
  }
  if (changed) {
    method_.jump(system_, state);
    settle(state, 0);
  } else {
    // The coordinate whose force is nearest to its limit begins to slide.
    const VectorXd& r = system_.residual(state);
    int nearest = none;
    double largest = -1e-3;
    for (int i = 0; i < std::ssize(model_.stictions); ++i)
      if (state.sliding[i] == 0)
        if (const double e = excess(state, r, i); e > largest) largest = e, nearest = i;
    if (nearest != none) {
      state.sliding[nearest] = r[freedom(nearest)] > 0 ? -1 : 1;
      ++counters_.broken_away;
      method_.jump(system_, state);
      settle(state, 0);
    } else if (taken == 0) {
      // A coordinate that begins to slide turns back at once, by a force that changes within the step.
      taken = stride(h);
      for (int i = 0; i < std::ssize(model_.stictions); ++i)
        if (is_reversed(state, i)) hold(state, i);
      method_.jump(system_, state);
    }
  }
  method_.start(system_, state, h);
  return taken;
}

}  // namespace tandem::mbd
