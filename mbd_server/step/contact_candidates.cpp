// Which points are in contact: features are found and matched with the points of the step before.
#include "mbd_server/step/contact_candidates.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::mbd {
namespace {

// Where a ball comes to another face, the energy of the change of its rate against the surface matters from
// this share of the energy that moves on.
constexpr double least_jump = 1e-10;

}  // namespace

void ContactCandidates::find(const std::vector<LinkMotion>& links, double h,
                             std::vector<ContactPoint>& points) {
  find_pairs(model_, links, h, pairs_);
  all_.clear();
  watches_.clear();
  turned_.reset();
  std::vector<std::size_t> held;
  std::vector<bool> taken(points.size(), false);
  std::vector<Eigen::Index> kept;
  by_pair_.clear();
  for (std::size_t k = 0; k < points.size(); ++k)
    by_pair_.push_back({pair_of(points[k].feature), static_cast<Eigen::Index>(k)});
  std::sort(by_pair_.begin(), by_pair_.end());
  for (const NearPair& pair : pairs_) {
    const Range of_this = of_pair({pair.a, pair.b});
    const std::int64_t preferred = of_this.empty() ? -1 : points[of_this.back().point].feature.code;
    features_.clear();
    const ContactShape &one = model_.contact.shape(pair.a), &two = model_.contact.shape(pair.b);
    double depth = 0;
    if (one.mesh || two.mesh) {
      if (h == 0) depth = std::min(one.bound, two.bound);
      for (const OfPair& of : of_this) depth = std::max(depth, -gap(model_, points[of.point].feature, links));
    }
    find_features(model_, pair.a, pair.b, links, pair.reach, preferred, features_, depth);
    match(links, points, of_this);
    for (std::size_t i = 0; i < features_.size(); ++i) {
      const ContactFeature& feature = features_[i];
      if (feature.kind == ContactFeature::Kind::watch) {
        watches_.push_back({all_.size(), std::exchange(held, {}), pair.reach, depth});
        all_.push_back({feature, -1, rules_.tolerance(feature)});
        continue;
      }
      const Eigen::Index point = matches_[i];
      if (point < 0 && feature.on_mesh) continue;  // its watch sees it
      if (point == PointMatches::part_of_another) continue;
      if (feature.on_mesh) held.push_back(all_.size());
      all_.push_back({feature, point, rules_.tolerance(feature)});
      if (point < 0) continue;
      taken[static_cast<std::size_t>(point)] = true;
      follow(links, feature, points[point]);
      kept.push_back(point);
    }
  }
  for (std::size_t k = 0; k < points.size(); ++k)
    if (!taken[k])
      ledger_.lose(evaluate(model_, points[k], links, Derivatives::without).energy, points[k].feature.a,
                   points[k].feature.b);
  keep(points, std::move(kept));
}

ContactCandidates::Range ContactCandidates::of_pair(const ShapePair& pair) const {
  const auto first = std::lower_bound(by_pair_.begin(), by_pair_.end(), OfPair{pair, 0});
  auto last = first;
  while (last != by_pair_.end() && last->pair == pair) ++last;
  return {first, last};
}

// Finds which features of the pair continue which of its points in contact.
void ContactCandidates::match(const std::vector<LinkMotion>& links, const std::vector<ContactPoint>& points,
                              Range of_pair) {
  matches_.begin(features_.size());
  for (const OfPair& of : of_pair) {
    const ContactFeature& g = points[of.point].feature;
    for (std::size_t i = 0; i < features_.size(); ++i) {
      const ContactFeature& f = features_[i];
      if (f.kind == ContactFeature::Kind::watch || g.a != f.a || g.b != f.b || g.code != f.code) continue;
      if (!f.on_mesh)
        matches_.add(model_, g, features_, i, of.point);
      else if (const double distance = (foot(model_, g, links) - f.place_b).norm(); distance < same_foot(f))
        matches_.add(distance, i, of.point);
    }
  }
  matches_.choose(model_, features_);
}

// The point touches with the feature as it is now: of a face its corners have moved along its edges, on a
// mesh another part may be nearest. The energy of its spring that this takes counts as dissipated. Where the
// normal on a mesh has another direction, the body approaches the surface at once, and the next steps resolve
// it.
void ContactCandidates::follow(const std::vector<LinkMotion>& links, const ContactFeature& feature,
                               ContactPoint& point) {
  const ContactForce before = evaluate(model_, point, links, Derivatives::without);
  point.feature = feature;
  const ContactForce after = evaluate(model_, point, links, Derivatives::without);
  ledger_.lose(before.energy - after.energy, feature.a, feature.b);
  if (!feature.on_mesh) return;
  const double jump = after.n.dot(after.velocity) - before.n.dot(before.velocity);
  if (!(0.5 * point.mass * jump * jump > least_jump * rules_.energy_scale())) return;
  const double step = rules_.impact_step(point, 0, point.entry_rate);
  turned_ = turned_ ? std::min(*turned_, step) : step;
}

void ContactCandidates::keep(std::vector<ContactPoint>& points, std::vector<Eigen::Index> kept) {
  if (kept.size() == points.size()) return;
  std::sort(kept.begin(), kept.end());
  std::vector<Eigen::Index> place(points.size(), -1);
  Eigen::Index count = 0;
  for (const Eigen::Index k : kept) {
    place[static_cast<std::size_t>(k)] = count;
    if (k != count) points[count] = points[k];
    ++count;
  }
  points.resize(kept.size());
  for (ContactCandidate& c : all_)
    if (c.point >= 0) c.point = place[static_cast<std::size_t>(c.point)];
}

void ContactCandidates::measure(const std::vector<LinkMotion>& links, ContactGaps& gaps) {
  gaps.resize(all_.size());
  for (std::size_t i = 0; i < all_.size(); ++i) {
    if (all_[i].feature.kind == ContactFeature::Kind::watch) continue;
    gaps[i] = {};
    gaps[i].value = gap(model_, all_[i].feature, links, &gaps[i].rate);
  }
  for (const BallWatch& watch : watches_) {
    uncovered(links, watch, features_, &gaps);
    measure_watch(links, features_, gaps[watch.candidate]);
  }
}

}  // namespace tandem::mbd
