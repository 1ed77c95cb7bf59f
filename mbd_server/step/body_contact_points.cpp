// Which points come into contact, and what they are at the end of a step.
#include <algorithm>
#include <cmath>

#include "mbd_server/step/body_contacts.hpp"
#include "mbd_server/step/contact_springs.hpp"

namespace tandem::mbd {
namespace {

// Newton's method finds the depth of a contact to this share of that under the weight that the point feels.
constexpr double resolved = 1e-3;

}  // namespace

// Points within the tolerance whose shapes approach each other, or are pressed together, come into contact,
// and those that may do so within a step of length `ahead` that does not end there. Returns whether any of
// them begins an impact that is not faint.
bool BodyContacts::enter_all(State& state, double ahead, double uncut, bool at_start) {
  const auto& links = system_.links();
  entries_.clear();
  candidates_.enter_watched(links, at_start, [this](std::size_t candidate, double rate) {
    entries_.push_back({candidate, rate});
  });
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
    const bool early = uncut > 0 && distance > near && rules_.may_begin(f, distance, rate, uncut) &&
                       uncut <= rules_.uncut_step(f, rate);
    if (!early && !(distance <= near + (within ? ahead * std::max(0.0, -rate) : 0))) continue;
    if (!early && rate > 0 && distance >= -near) continue;
    candidates_.expect_round_side(f, distance);
    entries_.push_back({i, std::max(0.0, -rate)});
    entries_.back().faint = within || early || (!at_start && rate * rate < rules_.faint_square(f.a, f.b));
  }
  if (!entries_.empty()) masses_.find(candidates_, entries_);
  for (const ContactEntry& entry : entries_) enter(state, entry);
  masses_.press(state.contacts);
  return !std::ranges::all_of(entries_, &ContactEntry::faint);
}

void BodyContacts::enter(State& state, const ContactEntry& entry) {
  ContactCandidate& candidate = candidates_.all()[entry.candidate];
  const ContactFeature& feature = candidate.feature;
  const ContactShape &a = model_.contact.shape(feature.a), &b = model_.contact.shape(feature.b);
  const ContactLaw law = model_.contact.law(feature.a, feature.b);
  const auto& links = system_.links();
  const Touch t = touch(model_, feature, links, Derivatives::without);
  const double depth = std::max(-t.gap, impact_depth(law, entry.mass, entry.rate));
  // Hertz: over depth^1/2.
  const double stiffness = law.hertz ? 1.5 * law.stiffness : law.stiffness;
  candidate.point = std::ssize(state.contacts);
  ContactPoint& point = state.contacts.emplace_back();
  point.feature = feature;
  point.mass = entry.mass;
  point.mass_a = entry.mass_a, point.mass_b = entry.mass_b;
  point.entry_rate = entry.rate;
  point.entry_time = state.time;
  // A contact that begins at rest gets the period at a depth of the tolerance, until it is deeper.
  point.period = half_period(law, entry.mass, std::max(depth, rules_.tolerance()));
  const double under_weight = depth_of(law, entry.mass * model_.gravity.norm()),
               finest = std::max(resolved * under_weight, rules_.round_off()),
               by_norm = rules_.tolerance() * std::sqrt(static_cast<double>(model_.freedoms));
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
                       links[static_cast<std::size_t>(b.link)], point.rolling);
  }
  // A point that takes the place of another one begins with the energy of its depth.
  if (state.steps > 0) ledger_.lose(-normal_energy(law, -t.gap), feature.a, feature.b);
  if (!entry.faint) shorten(state, rules_.impact_step(point, 0, point.entry_rate));
  if (t.gap <= candidate.tolerance) ++counters_.contacts;
}

// The next steps have at most that length [s].
void BodyContacts::shorten(State& state, double longest) const {
  double& touch_step = state.touch_step[0];
  touch_step = touch_step > 0 ? std::min(touch_step, longest) : longest;
}

// The end of a step of length h: contacts that have ended, and friction that slides. Returns whether an
// impact has ended that the step resolves.
bool BodyContacts::accept(State& state, double h) {
  const auto& links = system_.links();
  double longest = HUGE_VAL;
  const bool any = !state.contacts.empty();
  bool impact_ended = false, uncut = false;
  extremes_ = {};
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    ContactCandidate& candidate = candidates_.all()[i];
    if (candidate.point < 0) continue;
    const Eigen::Index index = candidate.point;
    ContactPoint& point = state.contacts[index];
    const ContactLaw law = model_.contact.law(candidate.feature.a, candidate.feature.b);
    const ContactForce f = evaluate(model_, point, links, Derivatives::without);
    const ContactExchange& begin = ledger_.begin()[static_cast<std::size_t>(index)];
    const double done = ledger_.work(point, static_cast<std::size_t>(index), h);
    const int shape_a = candidate.feature.a, shape_b = candidate.feature.b;
    extremes_.force = std::max(extremes_.force, f.normal);
    if (const double share = -f.gap / thickness_at(model_, candidate.feature); share > extremes_.depth_share)
      extremes_.depth_share = share, extremes_.shape_a = shape_a, extremes_.shape_b = shape_b;
    const bool open = f.gap > 0, touched = begin.motion.gap <= candidate.tolerance,
               is_uncut = h <= rules_.uncut_step(point);
    uncut |= is_uncut && open == touched;
    const bool may_begin =
        open && !touched && is_uncut && rules_.may_begin(candidate.feature, f.gap, gaps_[i].rate, h);
    if (open && !may_begin && !rules_.returns_faintly(candidate.feature, f.gap, gaps_[i].rate)) {
      ledger_.lose(begin.energy - done, shape_a, shape_b);
      candidate.point = -1;
      impact_ended |= !is_uncut &&
                      h <= ContactRules::coarsest * point.period / ContactRules::steps_per_contact &&
                      !rules_.is_faint(candidate.feature, gaps_[i].rate, -gaps_before_[i].value);
      continue;
    }
    kept.push_back(index);
    if (begin.motion.gap > candidate.tolerance && !open) ++counters_.contacts;
    const ContactExchange& end = ledger_.end()[static_cast<std::size_t>(index)];
    if (law.hertz) point.period = rules_.period(point, -f.gap);
    const double since = state.time - point.entry_time,
                 entry_rate = since <= point.period ? point.entry_rate : 0;
    if (may_begin)
      point.entry_rate = std::max(0.0, -gaps_[i].rate), point.entry_time = state.time;
    else if (open)
      point.entry_rate = std::min(point.entry_rate, std::abs(gaps_[i].rate));
    else if (rules_.is_impact(state.time, point, end))
      longest = std::min(
          longest, rules_.impact_step(point, since, std::max(entry_rate, std::sqrt(end.square(point)))));
    else if (rules_.vibrates(point, end))
      longest = std::min(longest, point.period / ContactRules::steps_per_vibration);

    const double stored = normal_energy(law, -f.gap) + move_spring(model_, links, f, point) +
                          move_rolling_spring(model_, links, f, point);
    if (law.hertz) point.last_depth = std::max(0.0, -f.gap);
    ledger_.lose(begin.energy - stored - done, shape_a, shape_b);
  }
  candidates_.keep(state.contacts, std::move(kept));
  if (any) ++counters_.steps;
  double& touch_step = state.touch_step[0];
  if (touch_step == 0 && longest == HUGE_VAL) return impact_ended;
  touch_step = std::min(touch_step > 0 ? (uncut ? 1 : ContactRules::growth) * touch_step : HUGE_VAL, longest);
  if (touch_step >= requested_) touch_step = 0;
  return impact_ended;
}

}  // namespace tandem::mbd
