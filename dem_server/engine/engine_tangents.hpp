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
  SumTangentRuns sum_runs{view_.window, view_.lists.near, memory_.bodies, memory_.tangents.of_pair.data(),
                          memory_.tangents.of_run.data()};
  // The lists of the ranks, one after the other, are that of one process with all spheres.
  if (ranks_ != nullptr) {
    WindowProgress all = present_progress();
    auto& r = memory_.ranks;
    const std::uint32_t count = listed_pairs(all);
    const auto gather = [&](const auto& own, auto& of_all) {
      using T = std::remove_cvref_t<decltype(*of_all.data())>;
      std::vector<T> values(count);
      if (count > 0) exec_.download(own, std::span<T>(values));
      values = gathered(std::span<const T>(values), true);
      exec_.upload(of_all, std::span<const T>(values));
      return static_cast<std::uint32_t>(values.size());
    };
    all.near = gather(memory_.now.lists.near, r.near);
    gather(memory_.tangents.of_pair, r.tangent);
    exec_.upload(r.window, std::span<const WindowProgress>(&all, 1));
    sum_runs.window = r.window.data(), sum_runs.near = r.near.data(), sum_runs.tangent = r.tangent.data();
  }
  exec_.for_each(tangent_runs * WallTangent::entries, sum_runs);
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
