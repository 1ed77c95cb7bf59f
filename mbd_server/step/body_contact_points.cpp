// Which points are in contact: features are found and matched with the points of the step before, and those
// that touch anew enter.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mbd_server/step/body_contacts.hpp"

namespace tandem::mbd {
namespace {

// A point of a face within this share of the size of its shape is the one that was there a step before.
constexpr double same_place = 0.05;
// A point of a face begins to touch where those that do are farther away than this share of the smaller
// shape's size: two that are nearer would bear as one, with twice the stiffness.
constexpr double merged = 1e-4;
constexpr Eigen::Index part_of_another = -2;  // of such a point, in point_of_
// Newton's method finds the depth of a contact to this share of that under the weight that the point feels.
constexpr double resolved = 1e-3;
// A body is held along a contact where it gives way by less than this share of the other one.
constexpr double held = 1e-6;

}  // namespace

// The features that may touch within h. Those that touch keep their data; those that are no longer features
// are dropped.
void BodyContacts::find(State& state, double h) {
  const auto& links = system_.links();
  find_pairs(model_, links, h, pairs_);
  candidates_.clear();
  watches_.clear();
  turned_ = false;
  std::vector<std::size_t> held;
  std::vector<bool> taken(state.contacts.size(), false);
  std::vector<Eigen::Index> kept;
  by_pair_.clear();
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k) {
    const auto a = state.contacts[k].feature.a, b = state.contacts[k].feature.b;
    by_pair_.push_back({std::min(a, b), std::max(a, b), k});
  }
  std::sort(by_pair_.begin(), by_pair_.end());
  for (const NearPair& pair : pairs_) {
    const Range points = of_pair(pair.a, pair.b);
    const std::int64_t preferred = points.empty() ? -1 : state.contacts[points.back().point].feature.code;
    features_.clear();
    const ContactShape &one = model_.contact.shape(pair.a), &two = model_.contact.shape(pair.b);
    double depth = 0;
    if (one.mesh || two.mesh) {
      if (h == 0) depth = std::min(one.bound, two.bound);
      for (const OfPair& point : points)
        depth = std::max(depth, -gap(model_, state.contacts[point.point].feature, links));
    }
    find_features(model_, pair.a, pair.b, links, pair.reach, preferred, features_, depth);
    match(state, points);
    for (std::size_t i = 0; i < features_.size(); ++i) {
      const ContactFeature& feature = features_[i];
      if (feature.kind == ContactFeature::Kind::watch) {
        watches_.push_back({candidates_.size(), std::exchange(held, {}), pair.reach, depth});
        candidates_.push_back({feature, -1, tolerance(feature)});
        continue;
      }
      const Eigen::Index point = point_of_[i];
      if (point < 0 && feature.on_mesh) continue;  // its watch sees it
      if (point == part_of_another) continue;
      if (feature.on_mesh) held.push_back(candidates_.size());
      candidates_.push_back({feature, point, tolerance(feature)});
      if (point < 0) continue;
      taken[static_cast<std::size_t>(point)] = true;
      turned_ |= follow(state, feature, point);
      kept.push_back(point);
    }
  }
  for (Eigen::Index k = 0; k < std::ssize(state.contacts); ++k)
    if (!taken[static_cast<std::size_t>(k)])
      lose(evaluate(model_, state.contacts[k], links, Derivatives::without).energy,
           state.contacts[k].feature.a, state.contacts[k].feature.b);
  keep(state, kept);
}

BodyContacts::Range BodyContacts::of_pair(int a, int b) const {
  const auto first = std::lower_bound(by_pair_.begin(), by_pair_.end(), OfPair{a, b, 0});
  auto last = first;
  while (last != by_pair_.end() && last->a == a && last->b == b) ++last;
  return {first, last};
}

// Finds which features of the pair continue which of its points in contact: the nearest ones first, so that a
// feature does not take the point of its neighbour. Two points that touch stay two, however near they come.
void BodyContacts::match(const State& state, Range points) {
  matches_.clear();
  point_of_.assign(features_.size(), -1);
  for (const OfPair& point : points) {
    const ContactFeature g = state.contacts[point.point].feature;
    for (std::size_t i = 0; i < features_.size(); ++i) {
      const ContactFeature& f = features_[i];
      if (f.kind == ContactFeature::Kind::watch || g.a != f.a || g.b != f.b || g.code != f.code) continue;
      double distance = 0, most = HUGE_VAL;
      if (f.on_mesh)
        distance = (foot(model_, g, system_.links()) - f.place_b).norm(), most = same_foot(f);
      else if (f.by_place)
        distance = (g.place_a - f.place_a).norm(), most = same_place * model_.contact.shape(f.a).bound;
      if (distance < most) matches_.push_back({distance, i, point.point});
    }
  }
  std::ranges::sort(matches_);
  for (const Match& m : matches_) {
    if (point_of_[m.feature] >= 0 || std::ranges::find(point_of_, m.point) != point_of_.end()) continue;
    point_of_[m.feature] = m.point;
  }
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const ContactFeature& f = features_[i];
    if (!f.by_place || point_of_[i] >= 0) continue;
    const double size = std::min(model_.contact.shape(f.a).bound, model_.contact.shape(f.b).bound);
    for (std::size_t k = 0; k < features_.size(); ++k) {
      const bool stands = point_of_[k] >= 0 || (k < i && point_of_[k] != part_of_another);
      if (stands && (features_[k].place_a - f.place_a).norm() < merged * size) point_of_[i] = part_of_another;
    }
  }
}

// Leaves these columns, in the order of their indices.
void BodyContacts::keep(State& state, const std::vector<Eigen::Index>& columns) {
  std::vector<Eigen::Index> sorted = columns, place(state.contacts.size(), -1);
  std::sort(sorted.begin(), sorted.end());
  if (std::ssize(sorted) == std::ssize(state.contacts)) return;
  Eigen::Index count = 0;
  for (const Eigen::Index k : sorted) {
    place[static_cast<std::size_t>(k)] = count;
    if (k != count) state.contacts[count] = state.contacts[k];
    ++count;
  }
  state.contacts.resize(static_cast<std::size_t>(count));
  for (Candidate& c : candidates_)
    if (c.point >= 0) c.point = place[static_cast<std::size_t>(c.point)];
}

// Points within the tolerance whose shapes approach each other, or are pressed together, come into contact,
// and those that may do so within a step of length `ahead` that does not end there. Returns whether any of
// them begins an impact that is not faint.
bool BodyContacts::enter_all(State& state, double ahead, bool at_start) {
  const auto& links = system_.links();
  entries_.clear();
  for (Watch& watch : watches_) enter_watched(watch, at_start);
  const std::size_t count = candidates_.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (candidates_[i].point >= 0 || candidates_[i].feature.kind == ContactFeature::Kind::watch ||
        candidates_[i].feature.on_mesh)
      continue;
    double rate = 0;
    const double distance = gap(model_, candidates_[i].feature, links, &rate);
    const ContactFeature& f = candidates_[i].feature;
    const bool within = model_.contact.within_steps(f.a, f.b);
    const double near = candidates_[i].tolerance;
    if (!(distance <= near + (within ? ahead * std::max(0.0, -rate) : 0))) continue;
    if (rate > 0 && distance >= -near) continue;
    expect_round_side(f, distance);
    entries_.push_back({i, std::max(0.0, -rate)});
    entries_.back().faint = within || (!at_start && rate * rate < faint_square(f.a, f.b));
  }
  if (!entries_.empty()) find_masses();
  const Eigen::Index first = std::ssize(state.contacts);
  state.contacts.resize(static_cast<std::size_t>(first) + entries_.size());
  for (std::size_t i = 0; i < entries_.size(); ++i)
    enter(state, entries_[i], first + static_cast<Eigen::Index>(i));
  find_pressing_masses(state);
  return !std::ranges::all_of(entries_, &Entry::faint);
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
      double of_a = 0, of_b = 0;  // compliance
      along(model_.contact.shape(f.b).link, wrench, [&](int u, double part) { of_b += part * response_[u]; });
      along(model_.contact.shape(f.a).link, wrench, [&](int u, double part) { of_a -= part * response_[u]; });
      // Bodies that motions or loops hold have no inertia along the contact; any finite value serves.
      const double compliance = of_a + of_b;
      Entry& e = entries_[i];
      e.mass = compliance > 0 ? 1 / compliance : 1e6 * model_.contact.law(f.a, f.b).stiffness;
      if (machine_of(f.a) == machine_of(f.b)) of_a = of_b = compliance;
      e.mass_a = of_a > held * compliance ? 1 / of_a : 0, e.mass_b = of_b > held * compliance ? 1 / of_b : 0;
    }
    left -= now_.size();
  }
}

int BodyContacts::machine_of(int shape) const {
  return machine_of_link_[static_cast<std::size_t>(model_.contact.shape(shape).link)];
}

// Machines that touch each other, other than through what is held, press each other. The largest mass that a
// point of one of them feels counts, not their sum, which would damp each contact of a heap by its whole
// mass.
void BodyContacts::find_pressing_masses(State& state) {
  std::vector<int>& next = pressed_with_;
  next.resize(machine_of_link_.size());
  std::iota(next.begin(), next.end(), 0);
  pressing_.assign(next.size(), 0);
  const auto first = [&](int i) {
    while (next[static_cast<std::size_t>(i)] != i)
      i = next[static_cast<std::size_t>(i)] =
          next[static_cast<std::size_t>(next[static_cast<std::size_t>(i)])];
    return i;
  };
  const auto side = [&](int shape, double mass) { return mass > 0 ? machine_of(shape) : none; };
  for (const ContactPoint& p : state.contacts) {
    const int a = side(p.feature.a, p.mass_a), b = side(p.feature.b, p.mass_b);
    const auto add = [&](int machine, double mass) {
      if (machine == none) return;
      double& most = pressing_[static_cast<std::size_t>(machine)];
      most = std::max(most, mass);
    };
    add(a, p.mass_a), add(b, p.mass_b);
    if (a != none && b != none)
      next[static_cast<std::size_t>(std::max(first(a), first(b)))] = std::min(first(a), first(b));
  }
  for (std::size_t i = next.size(); i-- > 0;) {
    double& of_all = pressing_[static_cast<std::size_t>(first(static_cast<int>(i)))];
    of_all = std::max(of_all, pressing_[i]);
  }
  for (ContactPoint& p : state.contacts) {
    const int a = side(p.feature.a, p.mass_a), b = side(p.feature.b, p.mass_b), machine = a != none ? a : b;
    p.pressing_mass = machine != none ? pressing_[static_cast<std::size_t>(first(machine))] : p.mass;
  }
}

// Links that move with each other through joints or closures are one machine.
void BodyContacts::enter(State& state, const Entry& entry, Eigen::Index index) {
  Candidate& candidate = candidates_[entry.candidate];
  const ContactFeature& feature = candidate.feature;
  const ContactShape &a = model_.contact.shape(feature.a), &b = model_.contact.shape(feature.b);
  const ContactLaw law = model_.contact.law(feature.a, feature.b);
  const auto& links = system_.links();
  const Touch t = touch(model_, feature, links, Derivatives::without);
  const double depth = std::max(-t.gap, impact_depth(law, entry.mass, entry.rate));
  // Hertz: over depth^1/2.
  const double stiffness = law.hertz ? 1.5 * law.stiffness : law.stiffness;
  candidate.point = index;
  ContactPoint point;
  point.feature = feature;
  point.mass = entry.mass;
  point.mass_a = entry.mass_a, point.mass_b = entry.mass_b;
  point.entry_rate = entry.rate;
  point.entry_time = state.time;
  // A contact that begins at rest gets the period at a depth of the tolerance, until it is deeper.
  point.period = half_period(law, entry.mass, std::max(depth, tolerance_));
  const double under_weight = depth_of(law, entry.mass * model_.gravity.norm()),
               finest = std::max(resolved * under_weight, least_),
               by_norm = tolerance_ * std::sqrt(static_cast<double>(model_.freedoms));
  if (under_weight > 0 && finest < by_norm) point.finest = finest;
  // Without friction nothing is held along the surfaces, and no spring stores energy there.
  const double ratio = law.friction > 0 ? law.tangential_ratio : 0;
  point.friction.stiffness = ratio * stiffness;
  point.friction.damping = ratio * std::sqrt(stiffness * entry.mass);
  point.friction.on_a = in_link(links[static_cast<std::size_t>(a.link)], t.p);
  point.friction.on_b = in_link(links[static_cast<std::size_t>(b.link)], t.p);
  if (const double radius = rolling_radius(feature); law.rolling_friction > 0 && radius > 0) {
    const double at_radius = law.tangential_ratio * radius * radius;
    point.rolling.radius = radius;
    point.rolling.stiffness = at_radius * stiffness;
    point.rolling.damping = at_radius * std::sqrt(stiffness * entry.mass);
    set_rolling_spring(t.n, t.n, links[static_cast<std::size_t>(a.link)],
                       links[static_cast<std::size_t>(b.link)], point);
  }
  state.contacts[index] = point;
  // A point that takes the place of another one begins with the energy of its depth.
  if (state.steps > 0) lose(-normal_energy(law, -t.gap), feature.a, feature.b);
  if (!entry.faint) shorten(state, point);
  if (t.gap <= candidate.tolerance) ++counters_.contacts;
}

// The next steps resolve an impact of this point.
void BodyContacts::shorten(State& state, const ContactPoint& point) {
  double& touch_step = state.touch_step[0];
  const double longest = impact_step(point, 0, point.entry_rate);
  touch_step = touch_step > 0 ? std::min(touch_step, longest) : longest;
}

}  // namespace tandem::mbd
