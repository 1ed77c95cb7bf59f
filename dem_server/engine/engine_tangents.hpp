// The engine's members for the tangents of bodies' contacts (engine/interface_stiffness.hpp).
#pragma once

#include <algorithm>
#include <utility>

#include "dem_server/engine/engine_of.hpp"

namespace tandem::dem {

// Leaves them in tangent_sums_.
template <class Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::find_tangents(std::span<const BodyPose> poses) {
  exec_.upload(body_pose_, poses);
  exec_.for_each(view_.near_capacity,
                 FindWallTangents<Law, Real>{view_, body_pose_.data(), tangents_.data()});
  exec_.zero(tangent_runs_, tangent_runs_.size());
  exec_.for_each(tangent_runs * WallTangent::entries,
                 SumTangentRuns{view_.control, view_.near, slots_, tangents_.data(), tangent_runs_.data()});
  exec_.for_each(slots_ * WallTangent::entries,
                 SumTangents{slots_, tangent_runs_.data(), tangent_sums_.data()});
}

template <class Exec, class Law, class Real>
const std::vector<WallTangent>& EngineOf<Exec, Law, Real>::wall_tangents(std::span<const BodyPose> poses) {
  // Where windows are done again and again, those of the first time are of no use.
  tangents_asked_ = has_bodies() && !std::exchange(rolled_back_, false);
  if (has_bodies() && !std::ranges::equal(poses, tangent_poses_)) {
    find_tangents(poses);
    exec_.download(tangent_sums_, std::span<WallTangent>(wall_tangents_));
    tangent_poses_.assign(poses.begin(), poses.end());
  }
  return wall_tangents_;
}

}  // namespace tandem::dem
