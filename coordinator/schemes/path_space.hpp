// Paths of the boundary bodies over one window as points of a vector space, for the schemes that iterate on a
// path. All paths of a window begin alike; a point is the deviation of a path from a base path at the
// window's END: displacement and rotation on the group, rotations weighted with the body's radius of
// gyration. In between, the deviation is proportional to time (6 lengths [m] per body), or has its own end
// velocity (12 lengths: also the difference of velocity and angular velocity, times the window).
#pragma once

#include <Eigen/Core>

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

enum class Departure { straight, cubic };

class PathSpace {
 public:
  PathSpace(const scene::Scene& scene, Departure departure);

  Eigen::Index lengths() const { return departure_ == Departure::straight ? 6 : 12; }  // per body
  // to - from [m] (lengths() x bodies)
  Eigen::VectorXd difference(const protocol::MotionSet& to, const protocol::MotionSet& from) const;
  // from + point; a point of zeros gives exactly `from`.
  protocol::MotionSet moved(const protocol::MotionSet& from, const Eigen::VectorXd& point) const;
  // Size of the bodies' motion over the window [m].
  double motion(const protocol::MotionSet& path) const;
  double gyration(std::uint32_t body) const { return gyration_.at(body); }  // [m]

 private:
  Departure departure_;
  std::vector<double> gyration_;  // radius of gyration [m] (bodies of the scene)
};

}  // namespace tandem::launch
