#include "mbd_server/step/contact_cuts.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

ContactPassages find_passages(const ContactCandidates& candidates, const ContactRules& rules,
                              const std::vector<ContactPoint>& points, const ContactGaps& before,
                              const ContactGaps& after, double h) {
  ContactPassages all;
  all.uncut_step = h;
  ShapePair last;  // candidates are sorted by pairs
  const auto add = [&](double time, ContactChange change, std::size_t candidate, double uncut_step) {
    if (!all.first || time < all.first->time) all.first = {time, change, candidate};
    const ShapePair pair = pair_of(candidates[candidate].feature);
    all.pairs += pair != last;
    last = pair;
    all.uncut_step = std::min(all.uncut_step, uncut_step);
  };
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const ContactGap &g0 = before[i], &g1 = after[i];
    const ContactFeature& feature = candidates[i].feature;
    if (candidates[i].point >= 0) {
      if (std::abs(g1.off) > std::max(rules.tolerance(), off_share * -g1.value))
        add(std::max(0.0, h - g1.since), ContactChange::follows, i, 0);  // or it was so at the begin
      if (!(g0.value < 0 && g1.value > 0) || rules.is_faint(feature, g1.rate, -g0.value)) continue;
      const double uncut = rules.uncut_step(points[static_cast<std::size_t>(candidates[i].point)]);
      if (h <= uncut) continue;
      const Cubic path{g0.value, h * g0.rate, g1.value, h * g1.rate};
      const double at = bisect(path);
      if (at > early_end && at < late_end) add(h * at, ContactChange::ends, i, uncut);
      continue;
    }
    const double rate = std::max(std::abs(g0.rate), std::abs(g1.rate));
    if (rules.is_faint(feature, rate, -g1.value)) continue;
    // The depth over the step.
    const Cubic path{-g0.value, -h * g0.rate, -g1.value, -h * g1.rate};
    if (g1.value < -candidates[i].tolerance) {
      // Shapes that have just left each other move apart first.
      const double away = g0.rate > 0 ? bisect([&](double x) { return path.slope(x); }) : 0;
      add(h * bisect(path, away), ContactChange::begins, i, rules.uncut_step(feature, rate));
    } else if (g0.rate < 0 && g1.rate > 0) {
      const double t = bisect([&](double x) { return -path.slope(x); });
      if (path(t) > candidates[i].tolerance)
        add(h * t, ContactChange::returns, i, rules.uncut_step(feature, rate));
    }
  }
  return all;
}

StepCut::StepCut(const ContactPassage& first, const ContactCandidates& candidates, const ContactRules& rules,
                 double h, double time)
    : first_(first), candidates_(candidates), rules_(rules), h_(h), time_(time), high_(h), part_(first.time) {
  if (first.change == ContactChange::ends) part_ += 0.5 * late_share * h;
  if (first.change == ContactChange::follows) part_ = std::min(part_ + 0.5 * late_share * h, h);
}

StepCut::Verdict StepCut::look(double taken, const ContactGaps& gaps) {
  const int i = tries_++;
  double deepest = HUGE_VAL, rate = 0, near = rules_.tolerance();
  for (std::size_t k = 0; k < candidates_.size(); ++k)
    if (const ContactGap& g = gaps[k];
        candidates_[k].point < 0 && g.value / candidates_[k].tolerance < deepest / near)
      deepest = g.value, rate = g.rate, near = candidates_[k].tolerance;
  const ContactGap& g = gaps[first_.candidate];
  const double late = 0.5 * late_share * h_;
  if (first_.change == ContactChange::follows && deepest >= -near) {
    if (std::abs(g.off) <= std::max(rules_.tolerance(), off_share * -g.value) || i >= 8 || taken < part_)
      return Verdict::done;
    high_ = taken;
    part_ = std::max(taken - g.since + late, 0.5 * taken);
    return Verdict::again;
  }
  if (first_.change == ContactChange::ends && deepest >= -near) {
    const bool ended = g.value >= 0 && g.value <= late_share * h_ * std::abs(g.rate);
    if (ended || i >= 8 || taken < part_) return Verdict::done;
    (g.value < 0 ? low_ : high_) = taken;
    const double newton = taken - g.value / g.rate + late;
    part_ = newton > low_ && newton < high_ ? newton : (low_ + high_) / 2;
    return Verdict::again;
  }
  if (std::abs(deepest) <= near || high_ - low_ <= 1e-15 * std::max(h_, time_)) return Verdict::done;
  if (i == 0 && first_.change == ContactChange::returns && deepest > 0) return Verdict::whole;
  (deepest < 0 ? high_ : low_) = taken;
  const double newton = taken - deepest / rate;
  part_ = newton > low_ && newton < high_ && i % 8 != 7 ? newton : (low_ + high_) / 2;
  return Verdict::again;
}

double longest_step(const Model& model, const std::vector<LinkMotion>& links, const State& state,
                    const ContactCandidates& candidates, const ContactGaps& gaps, double h) {
  double longest = h;
  if (state.touch_step[0] > 0) longest = std::min(longest, state.touch_step[0]);
  for (std::size_t k = 0; k < candidates.size() && k < gaps.size(); ++k) {
    const ContactFeature& f = candidates[k].feature;
    const double room = std::max(0.0, gaps[k].value) + through * thickness_at(model, f);
    if (-gaps[k].rate * longest > room) longest = room / -gaps[k].rate;
  }
  // A rotation of a point with rolling friction is told from one in the other direction.
  for (const ContactPoint& point : state.contacts) {
    if (!(point.rolling.stiffness > 0)) continue;
    const double w = (link_of(model, point.feature.b, links).V.head<3>() -
                      link_of(model, point.feature.a, links).V.head<3>())
                         .norm();
    if (w * longest > largest_turn) longest = largest_turn / w;
  }
  for (const ContactPoint& point : state.contacts) {
    if (!(point.friction.stiffness > 0)) continue;
    const ContactFeature& f = point.feature;
    if (!(std::max(model.contact.shape(f.a).radius, model.contact.shape(f.b).radius) > 0)) continue;
    const Vector3d n = touch(model, f, links, Derivatives::without).n,
                   w = (link_of(model, f.b, links).V - link_of(model, f.a, links).V).head<3>();
    const double rolling = (w - n.dot(w) * n).norm(), spin = std::abs(n.dot(w));
    if (rolling * longest > largest_roll) longest = largest_roll / rolling;
    if (spin * longest > largest_spin && rolling * longest > least_roll)
      longest = std::max(largest_spin / spin, least_roll / rolling);
  }
  for (const ContactShape& shape : model.contact.shapes) {
    if (shape.kind == ContactShape::Kind::sphere || shape.link == 0) continue;
    const double w = links[static_cast<std::size_t>(shape.link)].V.head<3>().norm();
    if (w * longest > largest_turn) longest = largest_turn / w;
  }
  return longest;
}

double resolving_step(const ContactRules& rules, const ContactLedger& ledger, const State& state,
                      double begin, double h) {
  double longest = HUGE_VAL;
  for (std::size_t k = 0; k < state.contacts.size(); ++k) {
    const ContactPoint& point = state.contacts[k];
    const ContactMotion& before = ledger.begin()[k].motion;
    const ContactExchange& now = ledger.end()[k];
    const bool flung = before.gap < 0 && now.motion.gap > 2 * late_share * h * std::abs(now.motion.gap_rate);
    if (before.gap > 0 && now.motion.gap > 0) continue;
    if (((now.motion.gap < 0 || flung) && rules.vibrates(point, now)) || rules.is_impact(begin, point, now))
      longest = std::min(longest, rules.period(point, -now.motion.gap) / ContactRules::steps_per_vibration);
  }
  return longest;
}

}  // namespace tandem::mbd
