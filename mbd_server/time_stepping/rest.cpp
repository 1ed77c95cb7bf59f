// Which bodies sleep: an island, of bodies in contact, that has been at rest for a while takes no part in
// steps until what moves may touch it.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mbd_server/time_stepping/as_index.hpp"
#include "mbd_server/time_stepping/time_stepping.hpp"

namespace tandem::mbd {
namespace {

constexpr Eigen::Index row_of_rest = 2;  // of State::island_steps
// A body is at rest whose rates are below this share of that of a fall through its size; an island sleeps
// after so much time at rest [s].
constexpr double least_rate_awake = 1e-5, asleep_after_rest = 0.1;

}  // namespace

bool TimeStepping::sleeps(const State& state, int body) const {
  return state.island_steps(row_of_rest, body) >= asleep_after_rest;
}

int TimeStepping::first(int body) {
  while (group_[as_index(body)] != body)
    body = group_[as_index(body)] = group_[as_index(group_[as_index(body)])];
  return body;
}

void TimeStepping::join(int body_a, int body_b) {
  if (body_a == none || body_b == none) return;
  const int x = first(body_a), y = first(body_b);
  group_[as_index(std::max(x, y))] = std::min(x, y);
}

void TimeStepping::wake(State& state) {
  const auto all = state.island_steps.row(row_of_rest);
  if (all.size() == 0 || all.maxCoeff() < asleep_after_rest) return;
  group_.resize(bodies_.size());
  std::iota(group_.begin(), group_.end(), 0);
  for (const ContactPoint& point : state.contacts) join(body_of(point.feature.a), body_of(point.feature.b));
  for (bool any = true; any;) {
    std::vector<bool> woken(bodies_.size(), false);
    any = false;
    near_.for_each_near([&](StepPoints::Pair& pair) {
      const int a = pair.a, b = pair.b;
      const auto asleep = [&](int shape) { return body_of(shape) != none && sleeps(state, body_of(shape)); };
      const auto moves = [&](int shape) {
        return body_of(shape) != none ? !sleeps(state, body_of(shape)) : near_.travel(shape) > 0;
      };
      if (!((asleep(a) && moves(b)) || (asleep(b) && moves(a))) || !near_.may_touch(pair)) return;
      woken[as_index(first(body_of(asleep(a) ? a : b)))] = any = true;
    });
    for (int body = 0; body < std::ssize(bodies_); ++body)
      if (woken[as_index(first(body))]) state.island_steps(row_of_rest, body) = 0;
  }
}

// Bodies that touch nothing do not rest, and those on something that moves as given do not either.
void TimeStepping::rest(State& state, double h) {
  const double g = model_.gravity.norm();
  group_.resize(bodies_.size());
  std::iota(group_.begin(), group_.end(), 0);
  std::vector<bool> borne(bodies_.size(), false), carried(bodies_.size(), false);
  for (const ContactPoint& point : state.contacts) {
    const int shapes[] = {point.feature.a, point.feature.b};
    join(body_of(shapes[0]), body_of(shapes[1]));
    for (int side = 0; side < 2; ++side) {
      const int body = body_of(shapes[side]), other = shapes[1 - side];
      if (body == none) continue;
      borne[as_index(body)] = true;
      const ContactShape& shape = model_.contact.shape(other);
      if (moves_as_given(other) && (near_.travel(other) > 0 || !shape.surface_velocity.isZero(0)))
        carried[as_index(body)] = true;
    }
  }
  std::vector<double> least(bodies_.size(), HUGE_VAL);
  for (std::size_t k = 0; k < awake_.size(); ++k) {
    const int body = awake_[k].body;
    const Vector6d& v = problem_.bodies[k].v;
    const double rate = v.tail<3>().norm() + v.head<3>().norm() * radius_[as_index(body)];
    const bool rests = g > 0 && borne[as_index(body)] && !carried[as_index(body)] &&
                       rate <= least_rate_awake * std::sqrt(2 * g * radius_[as_index(body)]);
    double& of_island = least[as_index(first(body))];
    of_island = std::min(of_island, rests ? state.island_steps(row_of_rest, body) + h : 0);
  }
  for (const Awake& one : awake_) {
    double& time = state.island_steps(row_of_rest, one.body);
    time = least[as_index(first(one.body))];
    if (!(time >= asleep_after_rest)) continue;
    const int u = bodies_[as_index(one.body)].u;
    for (VectorXd* rates : {&state.u, &state.udot, &state.a}) rates->segment<6>(u).setZero();
  }
}

}  // namespace tandem::mbd
