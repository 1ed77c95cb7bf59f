#include "mbd_server/step/dormand_prince.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

constexpr int last_stage = 6;

// [Dormand1980], table 2. The weights of order 5 are those of the last stage.
constexpr double nodes[] = {0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1, 1};
constexpr double coefficients[][last_stage] = {
    {},
    {1. / 5},
    {3. / 40, 9. / 40},
    {44. / 45, -56. / 15, 32. / 9},
    {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
    {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
    {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84}};
// Weights of order 5 less those of order 4.
constexpr double error_weights[] = {71. / 57600,      0,         -71. / 16695, 71. / 1920,
                                    -17253. / 339200, 22. / 525, -1. / 40};

// Product of step and rate above which the method is not stable on the negative real axis.
constexpr double limit_of_stability = 3.25;

// sum = h * (weighted sum of the first columns of `rates`)
void combine(const double* weights, int count, double h, const Eigen::MatrixXd& rates, VectorXd& sum) {
  sum = (h * weights[0]) * rates.col(0);
  for (int j = 1; j < count; ++j)
    if (weights[j] != 0) sum += (h * weights[j]) * rates.col(j);
}

}  // namespace

DormandPrince::DormandPrince(const System& system, const State& state)
    : rate_jump_(system, state),
      begin_(state),
      stage_(state),
      x_(VectorXd::Zero(state.u.size())),
      last_x_(x_),
      last_u_(x_),
      last_z_(state.z),
      x_rates_(state.u.size(), stages),
      u_rates_(state.u.size(), stages),
      z_rates_(state.z.size(), stages),
      rate_(x_),
      dx_(x_),
      du_(x_),
      dz_(state.z) {}

void DormandPrince::evaluate(System& system, State& state) {
  state.udot.setZero();
  state.udot = system.acceleration(state);
  ++counters_.evaluations;
  state.a = state.udot;
  if (state.z.size() > 0) state.zdot = state.w = system.state_rates();
}

// The first step to try: a tenth of the time in which a coordinate or a state of first order could change by
// its scale.
void DormandPrince::start(System& system, State& state, double h) {
  constexpr double share = 0.1;
  evaluate(system, state);
  state.udot_rate.setZero();
  state.zdot_rate.setZero();
  state.step = h;
  const double speed = system.norm(state.u), acceleration = system.norm(state.udot);
  state.next_step = std::min(
      {h, share / speed, share * std::sqrt(2 / acceleration), share / system.state_norm(state.zdot)});
}

void DormandPrince::jump(System& system, State& state) {
  evaluate(system, state);
  ++counters_.load_jumps;
}

void DormandPrince::jump(System& system, const State& before, State& state) {
  if (rate_jump_.apply(system, before, state)) ++counters_.factorisations;
  jump(system, state);
}

void DormandPrince::step(System& system, State& state, double h) {
  if (!try_step(system, state, h)) give_up(system, h);
}

std::optional<LocalError> DormandPrince::try_step(System& system, State& state, double h) {
  state.side = state.time;
  failed_at_ = state.time;
  failure_.clear();
  try {
    if (!take(system, state, h)) return {};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::numerics) throw;
    failure_ = error.problem();
    return {};
  }
  if (system.unseen(state, stage_) > largest_unseen) {
    failure_ = "a force over a coordinate changes within it";
    return {};
  }
  combine(error_weights, stages, h, x_rates_, dx_);
  combine(error_weights, stages, h, u_rates_, du_);
  if (state.z.size() > 0) combine(error_weights, stages, h, z_rates_, dz_);
  const LocalError error{system.norm(dx_), system.norm(du_), system.state_norm(dz_)};
  if (!std::isfinite(error.position + error.velocity + error.states)) return {};
  if (limited_by_stability(system, h)) ++counters_.stiff;

  begin_ = state;
  state.time = stage_.time;
  state.step = h;
  ++state.steps;
  ++counters_.steps;
  state.q = stage_.q;
  state.u = stage_.u;
  state.udot = u_rates_.col(last_stage);
  state.a = state.udot;
  state.udot_rate = (state.udot - begin_.udot) / h;
  if (state.z.size() > 0) {
    state.z = stage_.z;
    state.zdot = state.w = z_rates_.col(last_stage);
    state.zdot_rate = (state.zdot - begin_.zdot) / h;
  }
  return error;
}

// All stages of a step. Returns false where one of them is too far from the begin.
bool DormandPrince::take(System& system, const State& state, double h) {
  stage_ = state;
  stage_.udot.setZero();
  x_rates_.col(0) = state.u;
  u_rates_.col(0) = state.udot;
  z_rates_.col(0) = state.zdot;
  for (int s = 1; s < stages; ++s) {
    if (s == last_stage) last_x_ = x_, last_u_ = stage_.u, last_z_ = stage_.z;
    stage_.time = state.time + nodes[s] * h;
    combine(coefficients[s], s, h, x_rates_, x_);
    combine(coefficients[s], s, h, u_rates_, stage_.u);
    stage_.u += state.u;
    if (state.z.size() > 0) {
      combine(coefficients[s], s, h, z_rates_, stage_.z);
      stage_.z += state.z;
    }
    if (!system.increment_rate(x_, stage_.u, rate_)) return false;
    x_rates_.col(s) = rate_;
    system.move(state.q, x_, stage_.q);
    u_rates_.col(s) = system.acceleration(stage_);
    z_rates_.col(s) = system.state_rates();
    ++counters_.evaluations;
  }
  return true;
}

// The last two stages are at the same time: the ratio of the differences of their rates and of their states
// is an estimate of the fastest rate of the system. Increments are divided by h, so that their unit is that
// of the rates.
bool DormandPrince::limited_by_stability(const System& system, double h) {
  const auto difference = [&](const Eigen::MatrixXd& rates) {
    rate_ = rates.col(last_stage) - rates.col(last_stage - 1);
    return system.norm(rate_);
  };
  const double x_rate = difference(x_rates_), u_rate = difference(u_rates_);
  dz_ = z_rates_.col(last_stage) - z_rates_.col(last_stage - 1);
  const double z_rate = system.state_norm(dz_);
  last_x_ -= x_, last_u_ -= stage_.u, last_z_ -= stage_.z;
  const double x = system.norm(last_x_), u = system.norm(last_u_), z = system.state_norm(last_z_);
  return std::hypot(x_rate, h * u_rate, z_rate) > limit_of_stability * std::hypot(x / h, u, z / h);
}

void DormandPrince::give_up(const System&, double h) const {
  throw Error(ErrorCode::numerics,
              fmt::format("the explicit method cannot take a step of {:.3g} s at t = {:.9g} s{}", h,
                          failed_at_, failure_.empty() ? "" : ": " + failure_),
              "mbd_server", traits().collapsed);
}

ControlTraits DormandPrince::traits() const {
  return {
      .order = 5,
      .largest_factor = 5,
      .dead_band_low = 1,
      .dead_band_high = 1,
      .shortest_share = 1e-5,
      .collapsed =
          "a part that is stiff there takes an implicit method: leave out mbd.integrator.method, or write "
          "\"generalized_alpha\"; to resolve a fast motion, give a shorter mbd.integrator.step"};
}

}  // namespace tandem::mbd
