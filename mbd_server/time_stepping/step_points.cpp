#include "mbd_server/time_stepping/step_points.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "mbd_server/contact/touch.hpp"
#include "mbd_server/time_stepping/as_index.hpp"

namespace tandem::mbd {
namespace {

// As for points of steps that resolve impacts (contact_candidates.cpp): a point of a face within this share
// of the size of its shape is the one of the step before; one within this share of another one is part of it.
constexpr double same_place_in_step = 0.05, merged_in_step = 1e-4;
constexpr Eigen::Index part_of_other_feature = -2;
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
  find_pairs(model_, links, h, pairs_, &margins_);
}

// A plane that moves turns about its link: all of it counts as near.
bool StepPoints::is_near(const NearPair& pair) const {
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

bool StepPoints::may_touch(int a, int b) {
  features_.clear();
  find_features(solids_[as_index(a)], solids_[as_index(b)], reach(a, b), -1, features_);
  return std::ranges::any_of(features_,
                             [&](const ContactFeature& f) { return gap(model_, f, *links_) <= reach(a, b); });
}

void StepPoints::sort(std::vector<ContactPoint>& points) {
  const auto pair = [](const ContactPoint& point) { return pair_of(point.feature); };
  if (!std::ranges::is_sorted(points, {}, pair)) std::ranges::stable_sort(points, {}, pair);
}

void StepPoints::find(int a, int b, const std::vector<ContactPoint>& points, std::vector<Found>& found) {
  const ShapePair pair{a, b};
  const auto first = static_cast<std::size_t>(
      std::partition_point(points.begin(), points.end(),
                           [&](const ContactPoint& p) { return pair_of(p.feature) < pair; }) -
      points.begin());
  std::size_t last = first;
  while (last < points.size() && pair_at(points, last) == pair) ++last;
  features_.clear();
  find_features(solids_[as_index(a)], solids_[as_index(b)], reach(a, b),
                first == last ? -1 : points[last - 1].feature.code, features_);
  match(points, first, last);
  for (std::size_t i = 0; i < features_.size(); ++i)
    if (point_of_[i] != part_of_other_feature && gap(model_, features_[i], *links_) <= reach(a, b))
      found.push_back({features_[i], point_of_[i]});
}

// The nearest ones first, so that a feature does not take the point of its neighbour.
void StepPoints::match(const std::vector<ContactPoint>& points, std::size_t first, std::size_t last) {
  point_of_.assign(features_.size(), -1);
  auto& matches = matches_;
  matches.clear();
  for (std::size_t k = first; k < last; ++k) {
    const ContactFeature& g = points[k].feature;
    for (std::size_t i = 0; i < features_.size(); ++i) {
      const ContactFeature& f = features_[i];
      if (g.a != f.a || g.b != f.b || g.code != f.code) continue;
      const double distance = f.by_place ? (g.place_a - f.place_a).norm() : 0;
      if (distance <= same_place_in_step * model_.contact.shape(f.a).bound)
        matches.emplace_back(distance, i, k);
    }
  }
  std::ranges::sort(matches);
  for (const auto& [distance, i, k] : matches)
    if (point_of_[i] < 0 && std::ranges::find(point_of_, static_cast<Eigen::Index>(k)) == point_of_.end())
      point_of_[i] = static_cast<Eigen::Index>(k);
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const ContactFeature& f = features_[i];
    if (!f.by_place || point_of_[i] >= 0) continue;
    const double size = std::min(model_.contact.shape(f.a).bound, model_.contact.shape(f.b).bound);
    for (std::size_t k = 0; k < features_.size(); ++k) {
      const bool stands = point_of_[k] >= 0 || (k < i && point_of_[k] != part_of_other_feature);
      if (stands && (features_[k].place_a - f.place_a).norm() < merged_in_step * size)
        point_of_[i] = part_of_other_feature;
    }
  }
}

}  // namespace tandem::mbd
