#include "mbd_server/step/body_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/step/cubic.hpp"

namespace tandem::mbd {
namespace {

constexpr double steps_per_contact = 32;
// An impact of much damping loses most of its rate in a part of this share of its duration: steps there are
// shorter.
constexpr double sudden = 0.125;
double part_of_step(const ContactLaw& law) {
  return 1 / std::sqrt(1 + 0.5 * law.damping_number);
}
// Impacts that end again last one to some durations of one without loads.
constexpr double lasting = 10;
constexpr double growth = 2;  // of the steps after a contact
// Steps per half a period where a contact vibrates: where the energy of its rate is more than this share of
// the energy that moves.
constexpr double steps_per_vibration = 16, least_vibration = 1e-6;
// A body whose shape has corners or a length turns by at most this angle in a step [rad].
constexpr double largest_turn = 0.5;
// A step that passes the end of a contact within these shares of its length is not cut; one that is cut
// passes the end by at most late_share.
constexpr double early_end = 0.01, late_end = 0.99, late_share = 0.01;
// A point of a face within this share of the size of its shape is the one that was there a step before.
constexpr double same_place = 0.05;
// The spring of friction gets new ends where the point of contact has moved away by this share of the radius.
constexpr double rolled = 1e-3;
// Largest overlap at the start, as a share of the thinner shape: loads at rest press shapes by less.
constexpr double start_overlap = 0.1;

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
      unit_(VectorXd::Zero(state.u.size())),
      response_(unit_),
      dlambda_(VectorXd::Zero(system.constraints())),
      zero_(dlambda_) {
  if (!model.contact.empty()) find_machines();
}

void BodyContacts::prepare(State& state) {
  if (model_.contact.empty()) return;
  state.contacts.setZero(ContactRow::count, 0);
  state.touch_step.setZero(1);
  system_.residual(state);
  find(state, 0);
  enter_all(state);
  expect_apart(state, start_overlap, ErrorCode::scene, "overlap at the start",
               "move one of them: they would be thrown apart");
}

// Throws where two shapes overlap by more than this share of the thinner one: what they do then is no
// contact.
void BodyContacts::expect_apart(const State& state, double share, ErrorCode code, const char* what,
                                const char* hint) const {
  const auto thickness = [&](double shape) {
    const ContactShape& s = model_.contact.shape(static_cast<int>(shape));
    return s.kind == ContactShape::Kind::plane ? HUGE_VAL : s.thickness;
  };
  for (Eigen::Index k = 0; k < state.contacts.cols(); ++k) {
    const auto column = state.contacts.col(k);
    const double depth = -evaluate(model_, column, system_.links(), Derivatives::without).gap;
    const double a = column[ContactRow::shape_a], b = column[ContactRow::shape_b],
                 thinner = std::min(thickness(a), thickness(b));
    if (!(depth > share * thinner)) continue;
    throw Error(code,
                fmt::format("{} and {} {}, by {:.3g} m; the thinner one reaches {:.3g} m from its middle",
                            model_.contact.shape(static_cast<int>(a)).name,
                            model_.contact.shape(static_cast<int>(b)).name, what, depth, thinner),
                "mbd.contact", hint);
  }
}

double BodyContacts::step(State& state, double h, const Stride& stride) {
  if (model_.contact.empty()) return stride(h);
  system_.residual(state);
  find(state, h);
  system_.residual(state);
  if (enter_all(state)) method_.start(system_, state, longest_step(state, requested_));
  measure(state, gaps_before_);
  before_ = state;
  stops_before_ = stops_.mark();
  stiction_before_ = stiction_.counters();
  record(state, at_begin_);
  double limit = longest_step(state, h), taken = 0;
  while (true) {
    taken = stride(limit < h ? h / std::ceil(h / limit * (1 - 1e-9)) : h);
    measure(state, gaps_);
    if (const std::optional<Passage> first = passed(taken)) taken = cut(state, taken, *first, stride);
    record(state, at_end_);
    const double resolving = resolving_step(state);
    if (taken <= growth * resolving) break;
    limit = resolving;
    go_back(state);
  }
  accept(state, taken);
  expect_apart(state, 1, ErrorCode::numerics, "pass through each other",
               "give their materials more stiffness, so that they stop each other before that");
  if (enter_all(state)) method_.start(system_, state, longest_step(state, requested_));
  return taken;
}

// The features that may touch within h. Those that touch keep their data; those that are no longer features
// are dropped.
void BodyContacts::find(State& state, double h) {
  const auto& links = system_.links();
  find_pairs(model_, links, h, pairs_);
  candidates_.clear();
  std::vector<bool> taken(static_cast<std::size_t>(state.contacts.cols()), false);
  std::vector<Eigen::Index> kept;
  by_pair_.clear();
  for (Eigen::Index k = 0; k < state.contacts.cols(); ++k) {
    const auto a = static_cast<int>(state.contacts(ContactRow::shape_a, k)),
               b = static_cast<int>(state.contacts(ContactRow::shape_b, k));
    by_pair_.push_back({std::min(a, b), std::max(a, b), k});
  }
  std::sort(by_pair_.begin(), by_pair_.end());
  for (const NearPair& pair : pairs_) {
    const Range points = of_pair(pair.a, pair.b);
    const std::int64_t preferred =
        points.empty() ? -1
                       : static_cast<std::int64_t>(state.contacts(ContactRow::code, points.back().column));
    features_.clear();
    find_features(model_, pair.a, pair.b, links, pair.reach, preferred, features_);
    for (const ContactFeature& feature : features_) {
      const Eigen::Index column = matching(state, feature, points, taken);
      candidates_.push_back({feature, column});
      if (column < 0) continue;
      taken[static_cast<std::size_t>(column)] = true;
      set_feature(feature, state.contacts.col(column));
      kept.push_back(column);
    }
  }
  for (Eigen::Index k = 0; k < state.contacts.cols(); ++k)
    if (!taken[static_cast<std::size_t>(k)])
      lost_ += evaluate(model_, state.contacts.col(k), links, Derivatives::without).energy;
  keep(state, kept);
}

BodyContacts::Range BodyContacts::of_pair(int a, int b) const {
  const auto first = std::lower_bound(by_pair_.begin(), by_pair_.end(), OfPair{a, b, 0});
  auto last = first;
  while (last != by_pair_.end() && last->a == a && last->b == b) ++last;
  return {first, last};
}

// The column of the point in contact that the feature continues, or -1.
Eigen::Index BodyContacts::matching(const State& state, const ContactFeature& f, Range points,
                                    const std::vector<bool>& taken) const {
  Eigen::Index found = -1;
  double nearest = HUGE_VAL;
  for (const OfPair& point : points) {
    const Eigen::Index k = point.column;
    if (taken[static_cast<std::size_t>(k)]) continue;
    const ContactFeature g = feature_of(state.contacts.col(k));
    if (g.a != f.a || g.b != f.b || g.code != f.code) continue;
    if (!f.by_place) return k;
    const double distance = (g.place_a - f.place_a).norm();
    if (distance < nearest && distance < same_place * model_.contact.shape(f.a).bound)
      nearest = distance, found = k;
  }
  return found;
}

// Leaves these columns, in the order of their indices.
void BodyContacts::keep(State& state, const std::vector<Eigen::Index>& columns) {
  std::vector<Eigen::Index> sorted = columns, place(static_cast<std::size_t>(state.contacts.cols()), -1);
  std::sort(sorted.begin(), sorted.end());
  if (std::ssize(sorted) == state.contacts.cols()) return;
  Eigen::Index count = 0;
  for (const Eigen::Index k : sorted) {
    place[static_cast<std::size_t>(k)] = count;
    if (k != count) state.contacts.col(count) = state.contacts.col(k).eval();
    ++count;
  }
  state.contacts.conservativeResize(Eigen::NoChange, count);
  for (Candidate& c : candidates_)
    if (c.column >= 0) c.column = place[static_cast<std::size_t>(c.column)];
}

void BodyContacts::measure(State& state, Gaps& gaps) {
  system_.residual(state);
  gaps.resize(candidates_.size());
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    gaps[i].value = gap(model_, candidates_[i].feature, system_.links(), &gaps[i].rate);
}

// Estimates when a step of length h, from gaps_before_ to gaps_, passes the first begin or end of a contact.
std::optional<BodyContacts::Passage> BodyContacts::passed(double h) const {
  std::optional<Passage> first;
  const auto add = [&](double time, Change change, std::size_t candidate) {
    if (!first || time < first->time) first = {time, change, candidate};
  };
  for (std::size_t column = 0; column < candidates_.size(); ++column) {
    const Gap &g0 = gaps_before_[column], &g1 = gaps_[column];
    if (candidates_[column].column >= 0) {
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

void BodyContacts::go_back(State& state) {
  state = before_;
  stops_.back(stops_before_);
  stiction_.back(stiction_before_);
}

double BodyContacts::repeat(State& state, double h, const Stride& stride) {
  go_back(state);
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
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (const Gap& g = gaps_[k]; candidates_[k].column < 0 && g.value < deepest)
        deepest = g.value, rate = g.rate;
    if (first.change == Change::ends && deepest >= -tolerance_) {
      const Gap& g = gaps_[first.candidate];
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
  const auto& links = system_.links();
  entries_.clear();
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (candidates_[i].column >= 0) continue;
    double rate = 0;
    const double distance = gap(model_, candidates_[i].feature, links, &rate);
    if (!(distance <= tolerance_)) continue;
    if (rate > 0 && distance >= -tolerance_) continue;
    entries_.push_back({i, std::max(0.0, -rate)});
  }
  if (entries_.empty()) return false;
  find_masses();
  const Eigen::Index first = state.contacts.cols();
  state.contacts.conservativeResize(Eigen::NoChange, first + std::ssize(entries_));
  for (std::size_t i = 0; i < entries_.size(); ++i)
    enter(state, entries_[i], first + static_cast<Eigen::Index>(i));
  return true;
}

// The inertia that each point feels, closures included: a unit force gives the gap the rate 1/m. Points of
// machines that no closure connects share a solution, so that the cost is linear in the points.
void BodyContacts::find_masses() {
  response_.setZero();
  system_.factorise({.mass = 1, .damping = 0, .stiffness = 0}, response_);
  const auto& links = system_.links();
  const auto along = [&](LinkIndex link, const Vector6d& wrench, const auto& apply) {
    for (; link > 0; link = model_.links[static_cast<std::size_t>(link)].parent) {
      const Link& l = model_.links[static_cast<std::size_t>(link)];
      for (int j = 0; j < l.freedoms(); ++j)
        apply(l.u + j, links[static_cast<std::size_t>(link)].S.col(j).dot(wrench));
    }
  };
  for (std::size_t left = entries_.size(); left > 0;) {
    unit_.setZero();
    std::fill(busy_.begin(), busy_.end(), false);
    now_.clear();
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (entries_[i].mass > 0) continue;
      const ContactFeature& f = candidates_[entries_[i].candidate].feature;
      const int a = machine_of(f.a), b = machine_of(f.b);
      if ((a != none && busy_[static_cast<std::size_t>(a)]) ||
          (b != none && busy_[static_cast<std::size_t>(b)]))
        continue;
      if (a != none) busy_[static_cast<std::size_t>(a)] = true;
      if (b != none) busy_[static_cast<std::size_t>(b)] = true;
      now_.push_back(i);
      const Touch t = touch(model_, f, links, Derivatives::without);
      const Vector6d wrench = wrench_at(t.p, t.n);
      along(model_.contact.shape(f.b).link, wrench, [&](int u, double part) { unit_[u] += part; });
      along(model_.contact.shape(f.a).link, wrench, [&](int u, double part) { unit_[u] -= part; });
    }
    system_.solve(unit_, zero_, response_, dlambda_);
    for (const std::size_t i : now_) {
      const ContactFeature& f = candidates_[entries_[i].candidate].feature;
      const Touch t = touch(model_, f, links, Derivatives::without);
      const Vector6d wrench = wrench_at(t.p, t.n);
      double compliance = 0;
      along(model_.contact.shape(f.b).link, wrench,
            [&](int u, double part) { compliance += part * response_[u]; });
      along(model_.contact.shape(f.a).link, wrench,
            [&](int u, double part) { compliance -= part * response_[u]; });
      // Bodies that motions or loops hold have no inertia along the contact; any finite value serves.
      entries_[i].mass = compliance > 0 ? 1 / compliance : 1e6 * model_.contact.law(f.a, f.b).stiffness;
    }
    left -= now_.size();
  }
}

int BodyContacts::machine_of(int shape) const {
  return machine_of_link_[static_cast<std::size_t>(model_.contact.shape(shape).link)];
}

// Links that move with each other through joints or closures are one machine.
void BodyContacts::find_machines() {
  const std::size_t count = model_.links.size();
  std::vector<LinkIndex> root(count);
  for (std::size_t i = 0; i < count; ++i) {
    const LinkIndex parent = model_.links[i].parent;
    root[i] = i == 0 || parent <= 0 ? static_cast<LinkIndex>(i) : root[static_cast<std::size_t>(parent)];
  }
  // Each root refers to an earlier one of its machine, or to itself.
  const auto first = [&](LinkIndex i) {
    i = root[static_cast<std::size_t>(i)];
    while (root[static_cast<std::size_t>(i)] != i) i = root[static_cast<std::size_t>(i)];
    return i;
  };
  const auto join = [&](LinkIndex a, LinkIndex b) {
    a = first(a), b = first(b);
    if (a != 0 && b != 0) root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  };
  for (const Closure& c : model_.closures) {
    join(c.a, c.b);
    for (const CoupledLink& term : c.terms) join(c.a, term.link);
  }
  machine_of_link_.assign(count, none);
  for (std::size_t i = 1; i < count; ++i)
    machine_of_link_[i] = static_cast<int>(first(static_cast<LinkIndex>(i)));
  busy_.assign(count, false);
}

void BodyContacts::enter(State& state, const Entry& entry, Eigen::Index index) {
  Candidate& candidate = candidates_[entry.candidate];
  const ContactFeature& feature = candidate.feature;
  const ContactShape &a = model_.contact.shape(feature.a), &b = model_.contact.shape(feature.b);
  const ContactLaw law = model_.contact.law(feature.a, feature.b);
  const auto& links = system_.links();
  const Touch t = touch(model_, feature, links, Derivatives::without);
  const double depth = std::max(-t.gap, impact_depth(law, entry.mass, entry.rate));
  // Secant stiffness of the impact; a contact that begins at rest gets that of a depth of the tolerance.
  const double reached = std::max(depth, tolerance_);
  const double stiffness = law.hertz ? 1.5 * law.stiffness * std::sqrt(reached) : law.stiffness;
  candidate.column = index;
  ContactColumn column = ContactColumn::Zero();
  set_feature(feature, column);
  column[ContactRow::mass] = entry.mass;
  column[ContactRow::entry_rate] = entry.rate;
  column[ContactRow::entry_time] = state.time;
  column[ContactRow::period] = std::numbers::pi * std::sqrt(entry.mass / stiffness);
  // Without friction nothing is held along the surfaces, and no spring stores energy there.
  const double ratio = law.friction > 0 ? law.tangential_ratio : 0;
  column[ContactRow::stiffness] = ratio * stiffness;
  column[ContactRow::damping] = ratio * std::sqrt(stiffness * entry.mass);
  column.segment<3>(ContactRow::on_a) = in_link(links[static_cast<std::size_t>(a.link)], t.p);
  column.segment<3>(ContactRow::on_b) = in_link(links[static_cast<std::size_t>(b.link)], t.p);
  state.contacts.col(index) = column;
  double& touch_step = state.touch_step[0];
  const double part = column[ContactRow::period] / steps_per_contact * part_of_step(law);
  touch_step = touch_step > 0 ? std::min(touch_step, part) : part;
  ++counters_.contacts;
}

void BodyContacts::record(const State& state, std::vector<Exchange>& at) {
  at.resize(static_cast<std::size_t>(state.contacts.cols()));
  for (Eigen::Index k = 0; k < state.contacts.cols(); ++k) {
    at[static_cast<std::size_t>(k)] =
        exchange_of(evaluate(model_, state.contacts.col(k), system_.links(), Derivatives::without));
  }
}

BodyContacts::Exchange BodyContacts::exchange_of(const ContactForce& f) {
  const double gap_rate = f.n.dot(f.velocity);
  return {f.gap,    gap_rate, f.stretch, f.velocity - gap_rate * f.n, f.force.dot(f.velocity),
          f.energy, f.slides};
}

// Work of a point on the links over a step, by Simpson's rule; in the middle of the step gap and stretch are
// those of the cubics through both ends (energy_balance.hpp).
double BodyContacts::work(const ContactColumn& column, const Exchange& begin, const Exchange& end,
                          double h) const {
  if (!(h > 0)) return 0;
  const auto between = [&](const auto& x0, const auto& x1, const auto& v0, const auto& v1) {
    using Value = std::decay_t<decltype(x0)>;
    return std::pair{Value(0.5 * (x0 + x1) + h / 8 * (v0 - v1)),
                     Value(1.5 / h * (x1 - x0) - 0.25 * (v0 + v1))};
  };
  const auto [gap, gap_rate] = between(begin.gap, end.gap, begin.gap_rate, end.gap_rate);
  const auto [stretch, sliding] = between(begin.stretch, end.stretch, begin.sliding, end.sliding);
  return h / 6 * (begin.power + 4 * power(model_, column, gap, gap_rate, stretch, sliding) + end.power);
}

// The end of a step of length h: contacts that have ended, and friction that slides.
void BodyContacts::accept(State& state, double h) {
  const auto& links = system_.links();
  double longest = HUGE_VAL;
  const bool any = state.contacts.cols() > 0;
  std::vector<Eigen::Index> kept;
  for (Candidate& candidate : candidates_) {
    if (candidate.column < 0) continue;
    const Eigen::Index index = candidate.column;
    auto column = state.contacts.col(index);
    const ContactLaw law = model_.contact.law(candidate.feature.a, candidate.feature.b);
    const ContactForce f = evaluate(model_, column, links, Derivatives::without);
    const Exchange& begin = at_begin_[static_cast<std::size_t>(index)];
    const double done = work(column, begin, at_end_[static_cast<std::size_t>(index)], h);
    counters_.largest_force = std::max(counters_.largest_force, f.normal);
    counters_.largest_depth = std::max(counters_.largest_depth, -f.gap);
    if (f.gap > 0) {
      lost_ += begin.energy - done;
      candidate.column = -1;
      continue;
    }
    kept.push_back(index);
    const double period = column[ContactRow::period];
    const double since = state.time - column[ContactRow::entry_time];
    if (since <= lasting * period)
      longest =
          std::min(longest, period / steps_per_contact * (since < sudden * period ? part_of_step(law) : 1));
    else if (vibrates(column, at_end_[static_cast<std::size_t>(index)]))
      longest = std::min(longest, period / steps_per_vibration);

    // The stretch that has the friction with which the step ended, without its damping.
    const double stiffness = column[ContactRow::stiffness];
    Vector3d stretch = f.stretch;
    if (f.slides || f.normal == 0) {
      const Vector3d v_t = f.velocity - f.n.dot(f.velocity) * f.n,
                     elastic = f.friction + column[ContactRow::damping] * v_t;
      stretch = Vector3d::Zero();
      if (elastic.dot(f.friction) > 0) stretch = -elastic / stiffness;
    }
    const ContactShape &a = model_.contact.shape(candidate.feature.a),
                       &b = model_.contact.shape(candidate.feature.b);
    const LinkMotion &link_a = links[static_cast<std::size_t>(a.link)],
                     &link_b = links[static_cast<std::size_t>(b.link)];
    const Vector3d away = f.p - link_a.point(column.segment<3>(ContactRow::on_a));
    const double radius = std::max(a.radius, b.radius);
    const bool has_rolled = radius > 0 && (away - f.n.dot(away) * f.n).norm() > rolled * radius;
    if (f.slides || f.normal == 0 || has_rolled) {
      column.segment<3>(ContactRow::on_a) = link_a.R_WL.transpose() * (f.p - link_a.p_WL);
      column.segment<3>(ContactRow::on_b) = link_b.R_WL.transpose() * (f.p + stretch - link_b.p_WL);
    }
    const double stored = normal_energy(law, -f.gap) + 0.5 * stiffness * stretch.squaredNorm();
    lost_ += begin.energy - stored - done;
  }
  keep(state, kept);
  if (any) ++counters_.steps;
  double& touch_step = state.touch_step[0];
  if (touch_step == 0 && longest == HUGE_VAL) return;
  touch_step = std::min(touch_step > 0 ? growth * touch_step : HUGE_VAL, longest);
  if (touch_step >= requested_) touch_step = 0;
}

// A load that jumps makes a body vibrate on its contacts. A step that does not resolve this has another
// energy, and dampers at the points take another part of it.
bool BodyContacts::vibrates(const ContactColumn& column, const Exchange& now) const {
  if (!(now.gap < 0)) return false;
  const bool held = column[ContactRow::stiffness] > 0 && !now.slides;
  const double rate = now.gap_rate * now.gap_rate + (held ? now.sliding.squaredNorm() : 0);
  return 0.5 * column[ContactRow::mass] * rate > least_vibration * energy_scale_;
}

// Longest step that resolves the vibrations at the end of a step [s].
double BodyContacts::resolving_step(const State& state) const {
  double longest = HUGE_VAL;
  for (Eigen::Index k = 0; k < state.contacts.cols(); ++k)
    if (vibrates(state.contacts.col(k), at_end_[static_cast<std::size_t>(k)]))
      longest = std::min(longest, state.contacts(ContactRow::period, k) / steps_per_vibration);
  return longest;
}

double BodyContacts::longest_step(const State& state, double h) const {
  double longest = h;
  if (state.touch_step[0] > 0) longest = std::min(longest, state.touch_step[0]);
  for (std::size_t k = 0; k < candidates_.size() && k < gaps_before_.size(); ++k) {
    // A body that moves by more than the gap and half the thickness may pass through.
    const ContactFeature& f = candidates_[k].feature;
    const ContactShape &a = model_.contact.shape(f.a), &b = model_.contact.shape(f.b);
    const double room = std::max(0.0, gaps_before_[k].value) + std::min(a.thickness, b.thickness);
    if (-gaps_before_[k].rate * longest > room) longest = room / -gaps_before_[k].rate;
  }
  for (const ContactShape& shape : model_.contact.shapes) {
    if (shape.kind == ContactShape::Kind::sphere || shape.link == 0) continue;
    const double w = system_.links()[static_cast<std::size_t>(shape.link)].V.head<3>().norm();
    if (w * longest > largest_turn) longest = largest_turn / w;
  }
  return longest;
}

}  // namespace tandem::mbd
