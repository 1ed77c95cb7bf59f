// Paths of the boundary bodies over one window as points of a vector space, for the schemes that search one.
// All paths of a window begin alike; a point is how far the END of a path is from that of a base path:
// displacement and turn on the group, and velocity and angular velocity times the window, turns weighted with
// the body's radius of gyration: 12 lengths [m] per body.
#pragma once

#include <Eigen/Core>

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class PathSpace {
 public:
  explicit PathSpace(const scene::Scene& scene);

  // to - from [m] (12 x bodies)
  Eigen::VectorXd difference(const protocol::MotionSet& to, const protocol::MotionSet& from) const;
  // from + point; a point of zeros gives `from` to the bit.
  protocol::MotionSet moved(const protocol::MotionSet& from, const Eigen::VectorXd& point) const;
  // How far the bodies move in the window [m].
  double motion(const protocol::MotionSet& path) const;
  double gyration(std::uint32_t body) const { return gyration_.at(body); }  // [m]

 private:
  std::vector<double> gyration_;  // radius of gyration [m] (bodies of the scene)
};

}  // namespace tandem::launch
