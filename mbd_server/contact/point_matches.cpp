#include "mbd_server/contact/point_matches.hpp"

#include <algorithm>

namespace tandem::mbd {
namespace {

// A point of a face within this share of the size of its shape is the one that was there a step before.
constexpr double same_place = 0.05;
// A point of a face begins to touch where those that do are farther away than this share of the smaller
// shape's size: two that are nearer would bear as one, with twice the stiffness.
constexpr double merged = 1e-4;

}  // namespace

void PointMatches::begin(std::size_t features) {
  matches_.clear();
  point_of_.assign(features, -1);
}

void PointMatches::add(const Model& model, const ContactFeature& of_point,
                       const std::vector<ContactFeature>& features, std::size_t feature, Eigen::Index point) {
  const ContactFeature& f = features[feature];
  const double distance = f.by_place ? (of_point.place_a - f.place_a).norm() : 0;
  if (!f.by_place || distance < same_place * model.contact.shape(f.a).bound) add(distance, feature, point);
}

// The nearest ones first, so that a feature does not take the point of its neighbour. Two points that touch
// stay two, however near they come.
void PointMatches::choose(const Model& model, const std::vector<ContactFeature>& features) {
  std::ranges::sort(matches_);
  for (const Match& m : matches_) {
    if (point_of_[m.feature] >= 0 || std::ranges::find(point_of_, m.point) != point_of_.end()) continue;
    point_of_[m.feature] = m.point;
  }
  for (std::size_t i = 0; i < features.size(); ++i) {
    const ContactFeature& f = features[i];
    if (!f.by_place || point_of_[i] >= 0) continue;
    const double size = std::min(model.contact.shape(f.a).bound, model.contact.shape(f.b).bound);
    for (std::size_t k = 0; k < features.size(); ++k) {
      const bool stands = point_of_[k] >= 0 || (k < i && point_of_[k] != part_of_another);
      if (stands && (features[k].place_a - f.place_a).norm() < merged * size) point_of_[i] = part_of_another;
    }
  }
}

}  // namespace tandem::mbd
