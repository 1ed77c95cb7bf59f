// The bodies with walls, as a particle solver sees them from window to window.
#pragma once

#include <cstdint>
#include <string>

#include "common/ids.hpp"
#include "common/scene/model.hpp"
#include "particles/geometry/path.hpp"
#include "protocol/messages.hpp"

namespace tandem::particles {

struct BoundaryBody {
  BodyId body;
  std::string name;
  double extent = 0;  // distance of the farthest wall point from the body's origin; may be infinite [m]
};

// Motion of a boundary body at the end of the last window. Part of a solver's state.
struct LastMotion {
  Pose pose;
  Twist twist;
  std::uint64_t known = 0;  // 0 before the first window

  // Whether a file can have it.
  bool is_possible() const;
};

// The path of the body over the window of `motion`; the ground rests at the world's origin. Error{protocol}
// where `motion` lacks the body.
PathSegment segment_of(const BoundaryBody& boundary, const protocol::MotionSet& motion);

// Pose and twist of the scene; those of the ground are zero.
BodyPose pose_at_start(BodyId body, const scene::Scene& scene);

}  // namespace tandem::particles
