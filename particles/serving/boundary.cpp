#include "particles/serving/boundary.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/scene/tolerance.hpp"

namespace tandem::particles {

bool LastMotion::is_possible() const {
  return known <= 1 && is_finite(pose.p_WB) && scene::is_unit(std::sqrt(pose.q_WB.norm2())) &&
         is_finite(twist.v_WB) && is_finite(twist.w_WB);
}

PathSegment segment_of(const BoundaryBody& boundary, const protocol::MotionSet& motion) {
  if (boundary.body == ground) return {};
  const auto found = std::ranges::find(motion.bodies, boundary.body.value, &protocol::BodyMotion::body);
  if (found == motion.bodies.end())
    throw Error(ErrorCode::protocol, "no motion of body '" + boundary.name + "', which carries walls",
                "motion", "the multibody side must send every boundary body");
  return {found->begin_pose, found->end_pose, found->begin_twist, found->end_twist};
}

BodyPose pose_at_start(BodyId body, const scene::Scene& scene) {
  if (body == ground) return {.p = {}, .R = Quat{}.matrix(), .v = {}, .w = {}};
  const scene::Body& of_scene = scene.mbd->bodies[body.value];
  return {of_scene.pose.p_WB, of_scene.pose.q_WB.matrix(), of_scene.twist.v_WB, of_scene.twist.w_WB};
}

}  // namespace tandem::particles
