#include "mbd_server/time_stepping/step_points.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/contact/touch.hpp"
#include "mbd_server/time_stepping/as_index.hpp"

namespace tandem::mbd {
namespace {

// Pairs of shapes are looked for again when one has moved by this share of its size, or by so many steps.
constexpr double margin_of_shape = 0.2, steps_of_margin = 4;

ShapePair pair_at(const std::vector<ContactPoint>& points, std::size_t k) {
  return pair_of(points[k].feature);
}

}  // namespace

void StepPoints::begin(const std::vector<LinkMotion>& links, double h) {
  links_ = &links;
  const double g = model_.gravity.norm();
  bounds_.resize(model_.contact.shapes.size());
  solids_.clear();
  solids_.reserve(bounds_.size());
  bool moved = centres_.empty();
  for (std::size_t s = 0; s < bounds_.size(); ++s) {
    const ContactShape& shape = model_.contact.shapes[s];
    const LinkMotion& link = links[as_index(shape.link)];
    Bound& bound = bounds_[s];
    const Solid& solid = solids_.emplace_back(model_, static_cast<int>(s), links);
    bound.centre = solid.centre;
    const double rate = at_point(link.V, bound.centre).norm() + link.V.head<3>().norm() * shape.bound;
    bound.travel = shape.link == 0 ? 0 : h * (rate + h * g);
    moved = moved || (bound.centre - centres_[s]).norm() + bound.travel > margins_[s];
  }
  if (!moved) return;
  margins_.resize(bounds_.size());
  centres_.resize(bounds_.size());
  for (std::size_t s = 0; s < bounds_.size(); ++s) {
    const ContactShape& shape = model_.contact.shapes[s];
    const bool endless = shape.kind == ContactShape::Kind::plane;
    margins_[s] = shape.link == 0 ? 0
                                  : std::max(endless ? 0 : margin_of_shape * shape.bound,
                                             steps_of_margin * bounds_[s].travel);
    centres_[s] = bounds_[s].centre;
  }
  find_pairs(model_, links, h, nearest_, &margins_);
  pairs_.clear();
  for (const NearPair& pair : nearest_) pairs_.push_back({pair.a, pair.b});
  // So that points come in the order of sort().
  std::ranges::sort(pairs_, {}, [](const Pair& pair) { return ShapePair{pair.a, pair.b}; });
}

// A plane that moves turns about its link: all of it counts as near.
bool StepPoints::is_near(const Pair& pair) const {
  const ContactShape &a = model_.contact.shape(pair.a), &b = model_.contact.shape(pair.b);
  const auto above = [&](int plane, int other) {
    const ContactShape& shape = model_.contact.shape(plane);
    const Vector3d n = (*links_)[as_index(shape.link)].R_WL * shape.axes.col(2);
    return n.dot(bounds_[as_index(other)].centre - bounds_[as_index(plane)].centre);
  };
  double distance = 0, size = 0;
  if (a.kind == ContactShape::Kind::plane)
    distance = a.link == 0 ? above(pair.a, pair.b) : 0, size = b.bound;
  else if (b.kind == ContactShape::Kind::plane)
    distance = b.link == 0 ? above(pair.b, pair.a) : 0, size = a.bound;
  else
    distance = (bounds_[as_index(pair.a)].centre - bounds_[as_index(pair.b)].centre).norm(),
    size = a.bound + b.bound;
  return distance <= size + reach(pair.a, pair.b);
}

bool StepPoints::may_touch(Pair& pair) {
  const double most = reach(pair.a, pair.b);
  features_.clear();
  find_features(solids_[as_index(pair.a)], solids_[as_index(pair.b)], most, -1, features_, pair.apart);
  return std::ranges::any_of(features_,
                             [&](const ContactFeature& f) { return gap(model_, f, *links_) <= most; });
}

void StepPoints::sort(std::vector<ContactPoint>& points) {
  const auto pair = [](const ContactPoint& point) { return pair_of(point.feature); };
  if (std::ranges::is_sorted(points, {}, pair)) return;
  // Points are large: each is moved once.
  std::vector<std::pair<ShapePair, std::size_t>> order;
  order.reserve(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) order.emplace_back(pair_at(points, k), k);
  std::sort(order.begin(), order.end());
  std::vector<ContactPoint> sorted;
  sorted.reserve(points.size());
  for (const auto& [of, k] : order) sorted.push_back(points[k]);
  points.swap(sorted);
}

void StepPoints::find(Pair& near, const std::vector<ContactPoint>& points, std::vector<Found>& found) {
  const ShapePair pair{near.a, near.b};
  const double most = reach(near.a, near.b);
  const auto first = static_cast<std::size_t>(
      std::partition_point(points.begin(), points.end(),
                           [&](const ContactPoint& p) { return pair_of(p.feature) < pair; }) -
      points.begin());
  std::size_t last = first;
  while (last < points.size() && pair_at(points, last) == pair) ++last;
  features_.clear();
  find_features(solids_[as_index(near.a)], solids_[as_index(near.b)], most,
                first == last ? -1 : points[last - 1].feature.code, features_, near.apart);
  matches_.begin(features_.size());
  for (std::size_t k = first; k < last; ++k) {
    const ContactFeature& g = points[k].feature;
    for (std::size_t i = 0; i < features_.size(); ++i) {
      const ContactFeature& f = features_[i];
      if (g.a == f.a && g.b == f.b && g.code == f.code)
        matches_.add(model_, g, features_, i, static_cast<Eigen::Index>(k));
    }
  }
  matches_.choose(model_, features_);
  for (std::size_t i = 0; i < features_.size(); ++i)
    if (matches_[i] != PointMatches::part_of_another && gap(model_, features_[i], *links_) <= most)
      found.push_back({features_[i], matches_[i]});
}

}  // namespace tandem::mbd
