#include "mbd_server/step/body_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/step/cubic.hpp"

namespace tandem::mbd {
namespace {

constexpr double steps_per_contact = 32;
// Impacts that end again last one to some durations of one without loads.
constexpr double lasting = 10;
constexpr double growth = 2;  // of the steps after a contact
// A body whose shape has corners or a length turns by at most this angle in a step [rad].
constexpr double largest_turn = 0.5;
// A step that passes the end of a contact within these shares of its length is not cut; one that is cut
// passes the end by at most late_share.
constexpr double early_end = 0.01, late_end = 0.99, late_share = 0.01;
// The spring of friction gets new ends where the point of contact has moved away by this share of the radius.
constexpr double rolled = 1e-3;

}  // namespace

BodyContacts::BodyContacts(const Model& model, GeneralizedAlpha& method, MachineSystem& system,
                           const State& state, StopContacts& stops, Stiction& stiction)
    : model_(model),
      method_(method),
      system_(system),
      stops_(stops),
      stiction_(stiction),
      tolerance_(1e-10 * model.size),
      before_(state),
      gaps_before_(static_cast<std::size_t>(model.contact_points)),
      gaps_(gaps_before_),
      at_begin_(gaps_.size()),
      at_end_(gaps_.size()),
      unit_(VectorXd::Zero(state.u.size())),
      response_(unit_),
      dlambda_(VectorXd::Zero(system.constraints())),
      zero_(dlambda_) {}

template <class Act>
void BodyContacts::for_each_point(const Act& act) const {
  for (std::size_t k = 0; k < model_.contact_pairs.size(); ++k)
    for (int i = 0; i < model_.contact_pairs[k].count; ++i) act(k, i, model_.contact_pairs[k].first + i);
}

void BodyContacts::prepare(State& state) {
  if (model_.contact_pairs.empty()) return;
  state.contacts.setZero(ContactRow::count, model_.contact_points);
  state.touch_step.setZero(1);
  system_.residual(state);
  enter_all(state);
}

double BodyContacts::step(State& state, double h, const Stride& stride) {
  if (model_.contact_pairs.empty()) return stride(h);
  measure(state, gaps_before_);
  if (enter_all(state)) method_.start(system_, state, longest_step(state, requested_));
  before_ = state;
  stops_before_ = stops_.mark();
  stiction_before_ = stiction_.counters();
  record(state, at_begin_);
  const double limit = longest_step(state, h);
  double taken = stride(limit < h ? h / std::ceil(h / limit * (1 - 1e-9)) : h);
  measure(state, gaps_);
  if (const std::optional<Passage> first = passed(taken)) taken = cut(state, taken, *first, stride);
  accept(state, taken);
  if (enter_all(state)) method_.start(system_, state, longest_step(state, requested_));
  return taken;
}

void BodyContacts::measure(State& state, std::vector<Gap>& gaps) {
  system_.residual(state);
  for_each_point([&](std::size_t k, int i, int column) {
    Gap& g = gaps[static_cast<std::size_t>(column)];
    g.value = gap(model_, model_.contact_pairs[k], i, system_.links(), &g.rate);
  });
}

// Estimates when a step of length h, from gaps_before_ to gaps_, passes the first begin or end of a contact.
std::optional<BodyContacts::Passage> BodyContacts::passed(double h) const {
  std::optional<Passage> first;
  const auto add = [&](double time, Change change, int column) {
    if (!first || time < first->time) first = {time, change, column};
  };
  for (int column = 0; column < model_.contact_points; ++column) {
    const Gap &g0 = gaps_before_[static_cast<std::size_t>(column)],
              &g1 = gaps_[static_cast<std::size_t>(column)];
    if (touches(before_, column)) {
      if (!(g0.value < 0 && g1.value > 0)) continue;
      const Cubic path{g0.value, h * g0.rate, g1.value, h * g1.rate};
      const double at = bisect(path);
      if (at > early_end && at < late_end) add(h * at, Change::ends, column);
      continue;
    }
    // The depth over the step.
    const Cubic path{-g0.value, -h * g0.rate, -g1.value, -h * g1.rate};
    if (g1.value < -tolerance_) {
      // Shapes that have just left each other move apart first.
      const double away = g0.rate > 0 ? bisect([&](double x) { return path.slope(x); }) : 0;
      add(h * bisect(path, away), Change::begins, column);
    } else if (g0.rate < 0 && g1.rate > 0) {
      const double t = bisect([&](double x) { return -path.slope(x); });
      if (path(t) > tolerance_) add(h * t, Change::returns, column);
    }
  }
  return first;
}

double BodyContacts::repeat(State& state, double h, const Stride& stride) {
  state = before_;
  stops_.back(stops_before_);
  stiction_.back(stiction_before_);
  const double taken = stride(h);
  measure(state, gaps_);
  return taken;
}

// Repeats the step so that it ends at the first begin or end of a contact. Begins are found to the tolerance;
// a step may pass an end by a small share of its length.
double BodyContacts::cut(State& state, double h, const Passage& first, const Stride& stride) {
  double low = 0, high = h, part = first.time;
  if (first.change == Change::ends) part += 0.5 * late_share * h;
  for (int i = 0;; ++i) {
    const double taken = repeat(state, part, stride);
    double deepest = HUGE_VAL, rate = 0;
    for (int column = 0; column < model_.contact_points; ++column)
      if (const Gap& g = gaps_[static_cast<std::size_t>(column)];
          !touches(before_, column) && g.value < deepest)
        deepest = g.value, rate = g.rate;
    if (first.change == Change::ends && deepest >= -tolerance_) {
      const Gap& g = gaps_[static_cast<std::size_t>(first.column)];
      const bool ended = g.value >= 0 && g.value <= late_share * h * std::abs(g.rate);
      if (ended || i >= 8 || taken < part) return taken;
      (g.value < 0 ? low : high) = taken;
      const double newton = taken - g.value / g.rate + 0.5 * late_share * h;
      part = newton > low && newton < high ? newton : (low + high) / 2;
      continue;
    }
    if (std::abs(deepest) <= tolerance_ || high - low <= 1e-15 * std::max(h, state.time)) return taken;
    // The shapes do not meet after all.
    if (i == 0 && first.change == Change::returns && deepest > 0) return repeat(state, h, stride);
    (deepest < 0 ? high : low) = taken;
    const double newton = taken - deepest / rate;
    part = newton > low && newton < high && i % 8 != 7 ? newton : (low + high) / 2;
  }
}

// Points within the tolerance whose shapes approach each other, or are pressed together, come into contact.
bool BodyContacts::enter_all(State& state) {
  bool any = false;
  const auto& links = system_.links();
  for_each_point([&](std::size_t k, int i, int column) {
    if (touches(state, column)) return;
    const ContactPair& pair = model_.contact_pairs[k];
    double rate = 0;
    const double distance = gap(model_, pair, i, links, &rate);
    if (!(distance <= tolerance_)) return;
    if (rate > 0 && distance >= -tolerance_) return;
    if (!any) {
      response_.setZero();
      system_.factorise({.mass = 1, .damping = 0, .stiffness = 0}, response_);
    }
    enter(state, k, i, std::max(0.0, -rate));
    any = true;
  });
  return any;
}

void BodyContacts::enter(State& state, std::size_t k, int i, double rate) {
  const ContactPair& pair = model_.contact_pairs[k];
  const ContactShape &a = model_.contact_shapes[static_cast<std::size_t>(pair.a)],
                     &b = model_.contact_shapes[static_cast<std::size_t>(pair.b)];
  const auto& links = system_.links();
  const Touch t = touch(model_, pair, i, links);
  // The inertia that the point feels, closures included: a unit force gives the gap the rate 1/m.
  const Vector6d wrench = wrench_at(t.p, t.n);
  unit_.setZero();
  const auto apply = [&](LinkIndex link, double sign) {
    for (; link > 0; link = model_.links[static_cast<std::size_t>(link)].parent) {
      const Link& l = model_.links[static_cast<std::size_t>(link)];
      for (int j = 0; j < l.freedoms(); ++j)
        unit_[l.u + j] += sign * links[static_cast<std::size_t>(link)].S.col(j).dot(wrench);
    }
  };
  apply(b.link, 1), apply(a.link, -1);
  system_.solve(unit_, zero_, response_, dlambda_);
  const double compliance = unit_.dot(response_);
  // Bodies that motions or loops hold have no inertia along the contact; any finite value serves.
  const double mass = compliance > 0 ? 1 / compliance : 1e6 * pair.law.stiffness;
  const double depth = std::max(-t.gap, impact_depth(pair.law, mass, rate));
  // Secant stiffness of the impact; a contact that begins at rest gets that of a depth of the tolerance.
  const double reached = std::max(depth, tolerance_);
  const double stiffness =
      pair.law.hertz ? 1.5 * pair.law.stiffness * std::sqrt(reached) : pair.law.stiffness;
  auto column = state.contacts.col(pair.first + i);
  column[ContactRow::mass] = mass;
  column[ContactRow::entry_rate] = rate;
  column[ContactRow::entry_time] = state.time;
  column[ContactRow::period] = std::numbers::pi * std::sqrt(mass / stiffness);
  column[ContactRow::stiffness] = pair.law.tangential_ratio * stiffness;
  column[ContactRow::damping] = pair.law.tangential_ratio * std::sqrt(stiffness * mass);
  const auto local = [&](LinkIndex link) {
    const LinkMotion& m = links[static_cast<std::size_t>(link)];
    return Vector3d(m.R_WL.transpose() * (t.p - m.p_WL));
  };
  column.segment<3>(ContactRow::on_a) = local(a.link);
  column.segment<3>(ContactRow::on_b) = local(b.link);
  double& touch_step = state.touch_step[0];
  const double part = column[ContactRow::period] / steps_per_contact;
  touch_step = touch_step > 0 ? std::min(touch_step, part) : part;
  ++counters_.contacts;
}

void BodyContacts::record(const State& state, std::vector<Exchange>& at) {
  for_each_point([&](std::size_t k, int i, int column) {
    Exchange& x = at[static_cast<std::size_t>(column)];
    x = {};
    if (!touches(state, column)) return;
    const ContactForce f = evaluate(model_, model_.contact_pairs[k], i, state, system_.links());
    x = {f.force.dot(f.velocity), f.energy};
  });
}

// The end of a step of length h: contacts that have ended, and friction that slides.
void BodyContacts::accept(State& state, double h) {
  const auto& links = system_.links();
  double longest = HUGE_VAL;
  bool any = false;
  for_each_point([&](std::size_t k, int i, int index) {
    if (!touches(state, index)) return;
    any = true;
    const ContactPair& pair = model_.contact_pairs[k];
    const ContactForce f = evaluate(model_, pair, i, state, links);
    auto column = state.contacts.col(index);
    const Exchange& begin = at_begin_[static_cast<std::size_t>(index)];
    const double work = 0.5 * h * (begin.power + f.force.dot(f.velocity));
    counters_.largest_force = std::max(counters_.largest_force, f.normal);
    counters_.largest_depth = std::max(counters_.largest_depth, -f.gap);
    if (f.gap > 0) {
      lost_ += begin.energy - work;
      column.setZero();
      return;
    }
    const double period = column[ContactRow::period];
    if (state.time - column[ContactRow::entry_time] <= lasting * period)
      longest = std::min(longest, period / steps_per_contact);

    // The stretch that has the friction with which the step ended, without its damping.
    const double stiffness = column[ContactRow::stiffness];
    Vector3d stretch = f.stretch;
    if (f.slides || f.normal == 0) {
      const Vector3d v_t = f.velocity - f.n.dot(f.velocity) * f.n,
                     elastic = f.friction + column[ContactRow::damping] * v_t;
      stretch = Vector3d::Zero();
      if (elastic.dot(f.friction) > 0) stretch = -elastic / stiffness;
    }
    const ContactShape &a = model_.contact_shapes[static_cast<std::size_t>(pair.a)],
                       &b = model_.contact_shapes[static_cast<std::size_t>(pair.b)];
    const LinkMotion &link_a = links[static_cast<std::size_t>(a.link)],
                     &link_b = links[static_cast<std::size_t>(b.link)];
    const Vector3d away = f.p - link_a.point(column.segment<3>(ContactRow::on_a));
    const double radius = std::max(a.radius, b.radius);
    const bool has_rolled = radius > 0 && (away - f.n.dot(away) * f.n).norm() > rolled * radius;
    if (f.slides || f.normal == 0 || has_rolled) {
      column.segment<3>(ContactRow::on_a) = link_a.R_WL.transpose() * (f.p - link_a.p_WL);
      column.segment<3>(ContactRow::on_b) = link_b.R_WL.transpose() * (f.p + stretch - link_b.p_WL);
    }
    const double stored = normal_energy(pair.law, -f.gap) + 0.5 * stiffness * stretch.squaredNorm();
    lost_ += begin.energy - stored - work;
  });
  if (any) ++counters_.steps;
  double& touch_step = state.touch_step[0];
  if (touch_step == 0 && longest == HUGE_VAL) return;
  touch_step = std::min(touch_step > 0 ? growth * touch_step : HUGE_VAL, longest);
  if (touch_step >= requested_) touch_step = 0;
}

double BodyContacts::longest_step(const State& state, double h) const {
  double longest = h;
  if (state.touch_step[0] > 0) longest = std::min(longest, state.touch_step[0]);
  for (const ContactShape& shape : model_.contact_shapes) {
    if (shape.kind == ContactShape::Kind::sphere || shape.link == 0) continue;
    const double w = system_.links()[static_cast<std::size_t>(shape.link)].V.head<3>().norm();
    if (w * longest > largest_turn) longest = largest_turn / w;
  }
  return longest;
}

}  // namespace tandem::mbd
