#include "mbd_server/step/body_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/contact/overlap.hpp"
#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/model/machines.hpp"
#include "mbd_server/step/cubic.hpp"

namespace tandem::mbd {
namespace {

// A body whose shape has corners or a length turns by at most this angle in a step [rad].
constexpr double largest_turn = 0.5;
// A round surface that rolls by the angle x in a step takes the end of its spring of friction along a
// cycloid, which differs from the way by x^3 / 6 of the radius: by 4e-4 of the way at this angle [rad].
constexpr double largest_roll = 0.05;
// A round surface that rolls by more than the least angle spins by at most the largest one in a step: its
// spin turns the way on which it rolls [rad].
constexpr double least_roll = 1e-3, largest_spin = 0.1;
// A step that passes the end of a contact within these shares of its length is not cut; one that is cut
// passes the end by at most late_share.
constexpr double early_end = 0.01, late_end = 0.99, late_share = 0.01;
// A ball on a mesh: the distance to the feature that the step holds may differ from that to the mesh by this
// share of the depth.
constexpr double off_share = 1e-3;
// A ball on a mesh, and whatever is thin, moves by at most its gap and this share of the way to its middle.
constexpr double through = 0.5;
// A step in which a ball goes through a face is halved down to this share of it.
constexpr double least_halved = 1e-3;
// Steps below this share of the time make no progress; more of them in a row, and as many as there are
// points, are an error.
constexpr double least_progress = 1e-14;
constexpr int most_stalled = 100;
// An impact is faint where its rate is that of a fall through this share of the size of the body, and its
// material loses half of the energy in an impact: what the steps leave out does not add up then.
constexpr double faint_fall = 1e-6, most_elastic = 0.7;
// The begin of a contact is found to this share of the depth under the weight of the body.
constexpr double weight_share = 0.01;

}  // namespace

BodyContacts::BodyContacts(const Model& model, GeneralizedAlpha& method, MachineSystem& system,
                           const State& state, StopContacts& stops, Stiction& stiction)
    : model_(model),
      method_(method),
      system_(system),
      stops_(stops),
      stiction_(stiction),
      tolerance_(1e-10 * model.size),
      least_(1e-14 * model.size),
      before_(state),
      unit_(VectorXd::Zero(state.u.size())),
      response_(unit_),
      dlambda_(VectorXd::Zero(system.constraints())),
      zero_(dlambda_) {
  lost_of_.assign(model.contact.outputs.size(), 0);
  for (const ContactShape& shape : model.contact.shapes) {
    const auto found = std::ranges::find(model.boundary, shape.body);
    const bool has = shape.body != none && found != model.boundary.end();
    const double square = shape.body == none ? HUGE_VAL : 2 * faint_fall * model.gravity.norm() * shape.bound;
    faint_square_.push_back(square);
    faint_energy_.push_back(shape.body == none
                                ? HUGE_VAL
                                : 0.5 * model.bodies[static_cast<std::size_t>(shape.body)].mass * square);
    weights_.push_back(shape.body == none
                           ? HUGE_VAL
                           : model.bodies[static_cast<std::size_t>(shape.body)].mass * model.gravity.norm());
    boundary_of_.push_back(has ? static_cast<int>(found - model.boundary.begin()) : none);
    records_impulses_ = records_impulses_ || has;
  }
  if (!model.contact.empty()) impulses_.setZero(6, std::ssize(model.boundary));
  if (model.contact.empty()) return;
  machine_of_link_ = machine_of_links(model);
  busy_.assign(model.links.size(), false);
}

// To which begins are found: stiff shapes, which their weight presses by little, have a smaller one [m].
double BodyContacts::tolerance(const ContactFeature& f) const {
  const double weight =
      std::min(weights_[static_cast<std::size_t>(f.a)], weights_[static_cast<std::size_t>(f.b)]);
  if (!(weight > 0)) return tolerance_;
  return std::clamp(weight_share * depth_of(model_.contact.law(f.a, f.b), weight), least_, tolerance_);
}

// Throws where two shapes overlap by more than this share of the thinner one: what they do then is no
// contact.
void BodyContacts::expect_apart(const State& state, double share, ErrorCode code, const char* what,
                                const char* hint) const {
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k) {
    const auto& point = state.contacts[k];
    const double depth = -evaluate(model_, point, system_.links(), Derivatives::without).gap;
    const ContactFeature feature = point.feature;
    const double thinner = thickness_at(model_, feature);
    if (!(depth > share * thinner)) continue;
    throw Error(code,
                fmt::format("{} and {} {}, by {:.3g} m; the thinner one reaches {:.3g} m from its middle",
                            model_.contact.shape(feature.a).name, model_.contact.shape(feature.b).name, what,
                            depth, thinner),
                "mbd.contact",
                hint + (code == ErrorCode::scene
                            ? files_of(model_.contact.shape(feature.a), model_.contact.shape(feature.b))
                            : std::string()));
  }
}

void BodyContacts::lose(double energy, int shape_a, int shape_b) {
  lost_ += energy;
  model_.contact.for_each_output(
      shape_a, shape_b, [&](int output, double) { lost_of_[static_cast<std::size_t>(output)] += energy; });
}

double BodyContacts::step(State& state, double h, const Stride& stride) {
  if (model_.contact.empty()) return stride(h);
  system_.residual(state);
  find(state, h);
  system_.residual(state);
  if (enter_all(state, h) || turned_) start_method(state);
  measure(state, gaps_before_);
  for (Watch& watch : watches_) watch.centre = on_mesh(candidates_[watch.candidate].feature);
  before_ = state;
  stops_before_ = stops_.mark();
  stiction_before_ = stiction_.counters();
  shortened_before_ = method_.shortened();
  record(state, at_begin_, at_begin_wrench_);
  double limit = longest_step(state, h), taken = 0;
  while (true) {
    const double planned = limit < h ? h / std::ceil(h / limit * (1 - 1e-9)) : h;
    make_ready(state, planned);
    taken = stride(planned);
    // Where Newton's method fails, the contacts may be what the step does not resolve.
    const double resolved = shortest_period(before_) / steps_per_vibration;
    if (method_.shortened().count > shortened_before_.count && taken > growth * resolved) {
      limit = resolved;
      go_back(state);
      state.touch_step[0] = limit;
      continue;
    }
    measure(state, gaps_);
    if (taken > least_halved * h && went_through()) {
      limit = 0.5 * taken;
      go_back(state);
      continue;
    }
    const std::optional<Passage> first = passed(taken);
    if (first) taken = cut(state, taken, *first, stride);
    expect_progress(h, taken, first);
    record(state, at_end_, at_end_wrench_);
    const double resolving = resolving_step(state, taken);
    if (taken <= growth * resolving) break;
    limit = resolving;
    go_back(state);
  }
  integrate_wrenches(state, taken);
  const bool impact_ended = accept(state, taken);
  expect_apart(state, 1, ErrorCode::numerics, "pass through each other",
               "give their materials more stiffness, so that they stop each other before that");
  // After the end of an impact the algorithmic acceleration still has a part of its force, whose effect would
  // grow with the steps.
  if (enter_all(state) || impact_ended) start_method(state);
  return taken;
}

// Before a step of length h, or of the one that error control tries next. The rate of u' over a much shorter
// step before, in which a contact ended or began, tells nothing of this one (GeneralizedAlpha::start()).
void BodyContacts::make_ready(State& state, double h) {
  if (state.next_step > 0) h = std::min(h, state.next_step);
  aim_springs(state, h);
  aim_rolling_springs(state, h);
  if (h > growth * state.step &&
      h * h * system_.norm(state.udot_rate) > system_.norm(state.u) + h * system_.norm(state.udot))
    state.udot_rate.setZero();
}

// Throws where events of contacts leave no length to many steps in a row.
void BodyContacts::expect_progress(double h, double taken, const std::optional<Passage>& first) {
  stalled_ = first && taken <= least_progress * std::max(h, before_.time) ? stalled_ + 1 : 0;
  if (stalled_ <= most_stalled + std::ssize(candidates_)) return;
  const ContactFeature& f = candidates_[first->candidate].feature;
  throw Error(ErrorCode::numerics,
              fmt::format("{} and {} begin and end their contact without end", model_.contact.shape(f.a).name,
                          model_.contact.shape(f.b).name),
              "mbd.contact",
              "give their materials a lower restitution, or move one of them a little at the start");
}

// Square of the rate below which an impact of two shapes is faint [m2/s2].
double BodyContacts::faint_square(int a, int b) const {
  static const double least = damping_number(most_elastic);
  if (model_.contact.law(a, b).damping_number < least) return 0;
  return std::min(faint_square_[static_cast<std::size_t>(a)], faint_square_[static_cast<std::size_t>(b)]);
}

// Whether neither the rate of the gap nor the energy of the spring at that depth is worth a step that ends
// there.
bool BodyContacts::is_faint(const ContactFeature& f, double rate, double depth) const {
  if (model_.contact.within_steps(f.a, f.b)) return true;
  return rate * rate < faint_square(f.a, f.b) && normal_energy(model_.contact.law(f.a, f.b), depth) <=
                                                     std::min(faint_energy_[static_cast<std::size_t>(f.a)],
                                                              faint_energy_[static_cast<std::size_t>(f.b)]);
}

// Whether shapes that have left each other come back at the rate of a faint impact at the most. Their point
// stays in the equations, which know when it bears again: one that begins within a step would get the energy
// of its depth for nothing.
bool BodyContacts::returns_faintly(const ContactFeature& f, double gap, double rate) const {
  return !f.on_mesh && rate * rate + 2 * model_.gravity.norm() * gap < faint_square(f.a, f.b);
}

void BodyContacts::measure(State& state, Gaps& gaps) {
  system_.residual(state);
  gaps.resize(candidates_.size());
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (candidates_[i].feature.kind == ContactFeature::Kind::watch) continue;
    gaps[i] = {};
    gaps[i].value = gap(model_, candidates_[i].feature, system_.links(), &gaps[i].rate);
  }
  for (const Watch& watch : watches_) {
    uncovered(watch, features_, &gaps);
    measure_watch(features_, gaps[watch.candidate]);
  }
}

// Estimates when a step of length h, from gaps_before_ to gaps_, passes the first begin or end of a contact.
std::optional<BodyContacts::Passage> BodyContacts::passed(double h) const {
  std::optional<Passage> first;
  const auto add = [&](double time, Change change, std::size_t candidate) {
    if (!first || time < first->time) first = {time, change, candidate};
  };
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Gap &g0 = gaps_before_[i], &g1 = gaps_[i];
    const ContactFeature& feature = candidates_[i].feature;
    if (candidates_[i].point >= 0) {
      if (std::abs(g1.off) > std::max(tolerance_, off_share * -g1.value))
        add(std::max(0.0, h - g1.since), Change::follows, i);  // or it was so at the begin
      if (!(g0.value < 0 && g1.value > 0) || is_faint(feature, g1.rate, -g0.value)) continue;
      const Cubic path{g0.value, h * g0.rate, g1.value, h * g1.rate};
      const double at = bisect(path);
      if (at > early_end && at < late_end) add(h * at, Change::ends, i);
      continue;
    }
    if (is_faint(feature, std::max(std::abs(g0.rate), std::abs(g1.rate)), -g1.value)) continue;
    // The depth over the step.
    const Cubic path{-g0.value, -h * g0.rate, -g1.value, -h * g1.rate};
    if (g1.value < -candidates_[i].tolerance) {
      // Shapes that have just left each other move apart first.
      const double away = g0.rate > 0 ? bisect([&](double x) { return path.slope(x); }) : 0;
      add(h * bisect(path, away), Change::begins, i);
    } else if (g0.rate < 0 && g1.rate > 0) {
      const double t = bisect([&](double x) { return -path.slope(x); });
      if (path(t) > candidates_[i].tolerance) add(h * t, Change::returns, i);
    }
  }
  return first;
}

void BodyContacts::go_back(State& state) {
  state = before_;
  stops_.back(stops_before_);
  stiction_.back(stiction_before_);
  method_.back(shortened_before_);
  system_.residual(state);
}

double BodyContacts::repeat(State& state, double h, const Stride& stride) {
  go_back(state);
  make_ready(state, h);
  const double taken = stride(h);
  measure(state, gaps_);
  return taken;
}

// Repeats the step so that it ends at the first begin or end of a contact. Begins are found to the tolerance;
// a step may pass an end by a small share of its length.
double BodyContacts::cut(State& state, double h, const Passage& first, const Stride& stride) {
  double low = 0, high = h, part = first.time;
  if (first.change == Change::ends) part += 0.5 * late_share * h;
  if (first.change == Change::follows) part = std::min(part + 0.5 * late_share * h, h);
  for (int i = 0;; ++i) {
    const double taken = repeat(state, part, stride);
    double deepest = HUGE_VAL, rate = 0, near = tolerance_;
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (const Gap& g = gaps_[k];
          candidates_[k].point < 0 && g.value / candidates_[k].tolerance < deepest / near)
        deepest = g.value, rate = g.rate, near = candidates_[k].tolerance;
    if (first.change == Change::follows && deepest >= -near) {
      const Gap& g = gaps_[first.candidate];
      if (std::abs(g.off) <= std::max(tolerance_, off_share * -g.value) || i >= 8 || taken < part)
        return taken;
      high = taken;
      part = std::max(taken - g.since + 0.5 * late_share * h, 0.5 * taken);
      continue;
    }
    if (first.change == Change::ends && deepest >= -near) {
      const Gap& g = gaps_[first.candidate];
      const bool ended = g.value >= 0 && g.value <= late_share * h * std::abs(g.rate);
      if (ended || i >= 8 || taken < part) return taken;
      (g.value < 0 ? low : high) = taken;
      const double newton = taken - g.value / g.rate + 0.5 * late_share * h;
      part = newton > low && newton < high ? newton : (low + high) / 2;
      continue;
    }
    if (std::abs(deepest) <= near || high - low <= 1e-15 * std::max(h, state.time)) return taken;
    // The shapes do not meet after all.
    if (i == 0 && first.change == Change::returns && deepest > 0) return repeat(state, h, stride);
    (deepest < 0 ? high : low) = taken;
    const double newton = taken - deepest / rate;
    part = newton > low && newton < high && i % 8 != 7 ? newton : (low + high) / 2;
  }
}

double BodyContacts::shortest_period(const State& state) const {
  double shortest = HUGE_VAL;
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k)
    shortest = std::min(shortest, state.contacts[k].period);
  return shortest;
}

// Longest step that resolves the vibrations and impacts of a step of length h [s]: those at its end, and
// those that ended so early in it that it was not cut there.
double BodyContacts::resolving_step(const State& state, double h) const {
  double longest = HUGE_VAL;
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k) {
    const auto& point = state.contacts[k];
    const ContactMotion& begin = at_begin_[static_cast<std::size_t>(k)].motion;
    const Exchange& now = at_end_[static_cast<std::size_t>(k)];
    const bool flung = begin.gap < 0 && now.motion.gap > 2 * late_share * h * std::abs(now.motion.gap_rate);
    if (begin.gap > 0 && now.motion.gap > 0) continue;
    if (((now.motion.gap < 0 || flung) && vibrates(point, now)) || is_impact(before_, point, now))
      longest = std::min(longest, period(point, -now.motion.gap) / steps_per_vibration);
  }
  return longest;
}

double BodyContacts::longest_step(const State& state, double h) const {
  double longest = h;
  if (state.touch_step[0] > 0) longest = std::min(longest, state.touch_step[0]);
  for (std::size_t k = 0; k < candidates_.size() && k < gaps_before_.size(); ++k) {
    const ContactFeature& f = candidates_[k].feature;
    const double room = std::max(0.0, gaps_before_[k].value) + through * thickness_at(model_, f);
    if (-gaps_before_[k].rate * longest > room) longest = room / -gaps_before_[k].rate;
  }
  // A rotation of a point with rolling friction is told from one in the other direction.
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k) {
    const ContactPoint& point = state.contacts[k];
    if (!(point.rolling.stiffness > 0)) continue;
    const double w = (link_of(model_, point.feature.b, system_.links()).V.head<3>() -
                      link_of(model_, point.feature.a, system_.links()).V.head<3>())
                         .norm();
    if (w * longest > largest_turn) longest = largest_turn / w;
  }
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k) {
    if (!(state.contacts[k].friction.stiffness > 0)) continue;
    const ContactFeature f = state.contacts[k].feature;
    if (!(std::max(model_.contact.shape(f.a).radius, model_.contact.shape(f.b).radius) > 0)) continue;
    const Vector3d n = touch(model_, f, system_.links(), Derivatives::without).n,
                   w = (link_of(model_, f.b, system_.links()).V - link_of(model_, f.a, system_.links()).V)
                           .head<3>();
    const double rolling = (w - n.dot(w) * n).norm(), spin = std::abs(n.dot(w));
    if (rolling * longest > largest_roll) longest = largest_roll / rolling;
    if (spin * longest > largest_spin && rolling * longest > least_roll)
      longest = std::max(largest_spin / spin, least_roll / rolling);
  }
  for (const ContactShape& shape : model_.contact.shapes) {
    if (shape.kind == ContactShape::Kind::sphere || shape.link == 0) continue;
    const double w = system_.links()[static_cast<std::size_t>(shape.link)].V.head<3>().norm();
    if (w * longest > largest_turn) longest = largest_turn / w;
  }
  return longest;
}

}  // namespace tandem::mbd
