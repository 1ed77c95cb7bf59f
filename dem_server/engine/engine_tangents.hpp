// The engine's members for the tangents of bodies' contacts (engine/interface_stiffness.hpp).
#pragma once

#include <algorithm>
#include <utility>

#include "dem_server/engine/engine_of.hpp"

namespace tandem::dem {

// Leaves the tangents in memory_.tangents.sum.
template <BackEnd Exec, class Law, class Real>
void EngineOf<Exec, Law, Real>::find_tangents(std::span<const BodyPose> poses) {
  exec_.upload(inflow_.body_pose, poses);
  exec_.for_each(view_.lists.near_capacity, FindWallTangents<Law, Real>{view_, inflow_.body_pose.data(),
                                                                        memory_.tangents.of_pair.data()});
  exec_.zero(memory_.tangents.of_run, memory_.tangents.of_run.size());
  exec_.for_each(tangent_runs * WallTangent::entries,
                 SumTangentRuns{view_.window, view_.lists.near, memory_.bodies,
                                memory_.tangents.of_pair.data(), memory_.tangents.of_run.data()});
  exec_.for_each(memory_.bodies * WallTangent::entries,
                 SumTangents{memory_.bodies, memory_.tangents.of_run.data(), memory_.tangents.sum.data()});
}

template <BackEnd Exec, class Law, class Real>
const std::vector<WallTangent>& EngineOf<Exec, Law, Real>::wall_tangents(std::span<const BodyPose> poses) {
  // A request after each window lets advance() compute the tangents of the next window in advance. This is
  // not done where windows are iterated: the tangents of a first iteration are never used.
  tangents_.requested = memory_.has_bodies() && !std::exchange(tangents_.rolled_back, false);
  if (memory_.has_bodies() && !std::ranges::equal(poses, tangents_.poses)) {
    find_tangents(poses);
    exec_.download(memory_.tangents.sum, std::span<WallTangent>(tangents_.of_body));
    tangents_.poses.assign(poses.begin(), poses.end());
  }
  return tangents_.of_body;
}

}  // namespace tandem::dem
