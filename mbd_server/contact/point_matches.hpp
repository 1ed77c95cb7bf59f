// Which features of a pair of shapes continue which of its points of the step before.
#pragma once

#include <compare>
#include <vector>

#include "mbd_server/contact/features.hpp"

namespace tandem::mbd {

class PointMatches {
 public:
  // The feature begins to touch so near to another one of its face that both would bear as one.
  static constexpr Eigen::Index part_of_another = -2;

  void begin(std::size_t features);
  // The feature may continue a point from which it is so far away [m].
  void add(double distance, std::size_t feature, Eigen::Index point) {
    matches_.push_back({distance, feature, point});
  }
  // The same for a feature that is not on a mesh, if it may.
  void add(const Model& model, const ContactFeature& of_point, const std::vector<ContactFeature>& features,
           std::size_t feature, Eigen::Index point);
  void choose(const Model& model, const std::vector<ContactFeature>& features);
  // The point that the feature continues; negative: none.
  Eigen::Index operator[](std::size_t feature) const { return point_of_[feature]; }

 private:
  struct Match {
    double distance;
    std::size_t feature;
    Eigen::Index point;
    auto operator<=>(const Match&) const = default;
  };
  std::vector<Match> matches_;
  std::vector<Eigen::Index> point_of_;  // (features)
};

}  // namespace tandem::mbd
