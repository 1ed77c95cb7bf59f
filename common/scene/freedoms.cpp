#include "common/scene/freedoms.hpp"

namespace tandem::scene {

std::vector<Freedom> freedoms_of(const Mbd& mbd) {
  std::vector<Freedom> result(mbd.bodies.size());
  std::vector<int> joints(mbd.bodies.size(), 0);
  for (const Joint& joint : mbd.joints) {
    if (joint.parent != ground || joint.child == ground) continue;
    const std::size_t body = joint.child.value;
    Freedom& of = result[body];
    if (joint.type == JointType::fixed || joint.motion) of.fixed = true;
    if (joint.type != JointType::revolute && joint.type != JointType::prismatic) continue;
    const Vec3d arm = mbd.bodies[body].pose.p_WB - joint.position, n = joint.axis;
    const Vec3d v = joint.type == JointType::revolute ? cross(n, arm) : n;
    const Vec3d w = joint.type == JointType::revolute ? n : Vec3d{};
    if (++joints[body] == 1)
      of.single = {v.x, v.y, v.z, w.x, w.y, w.z};
    else
      of.single.reset();
  }
  return result;
}

}  // namespace tandem::scene
