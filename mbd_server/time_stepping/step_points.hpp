// The points of contact of a step: near pairs of shapes, their features, and which of these continue points
// of the step before.
#pragma once

#include <vector>

#include "mbd_server/contact/point_matches.hpp"
#include "mbd_server/contact/solid.hpp"

namespace tandem::mbd {

class StepPoints {
 public:
  explicit StepPoints(const Model& model) : model_(model) {}

  // A feature that may touch within the step.
  struct Found {
    ContactFeature feature;
    Eigen::Index point;  // of the step before that it continues; -1: none
  };

  // Call first in a step of length h.
  void begin(const std::vector<LinkMotion>& links, double h);
  // Two shapes that may touch within the step.
  struct Pair {
    int a, b;
    int apart = -1;  // an axis that separates them, for find_features()
  };
  template <class F>
  void for_each_near(F&& f) {
    for (Pair& pair : pairs_)
      if (is_near(pair)) f(pair);
  }
  bool may_touch(Pair& pair);
  // The features of the pair; `points`: those of the step before, in the order of sort().
  void find(Pair& pair, const std::vector<ContactPoint>& points, std::vector<Found>& found);
  // Largest way of a point of the shape in the step, at the rates of its begin [m].
  double travel(int shape) const { return bounds_[static_cast<std::size_t>(shape)].travel; }

  // Points by pairs of shapes.
  static void sort(std::vector<ContactPoint>& points);

 private:
  struct Bound {  // sphere about a shape
    Vector3d centre;
    double travel;
  };
  bool is_near(const Pair& pair) const;
  double reach(int a, int b) const { return travel(a) + travel(b); }

  const Model& model_;
  const std::vector<LinkMotion>* links_ = nullptr;
  std::vector<Bound> bounds_;  // (shapes)
  std::vector<Solid> solids_;  // (shapes)
  // Pairs that are near while no shape has moved by more than its margin from where it was [m] (shapes).
  std::vector<Pair> pairs_;
  std::vector<double> margins_;
  std::vector<Vector3d> centres_;
  std::vector<NearPair> nearest_;
  std::vector<ContactFeature> features_;
  PointMatches matches_;
};

}  // namespace tandem::mbd
