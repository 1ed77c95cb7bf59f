#include "coordinator/start/start_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "common/error.hpp"
#include "coordinator/watch/motion_watch.hpp"

namespace tandem::launch {
namespace {

// Solvers that store states in single precision stay below.
constexpr double start_share = 1e-6;
constexpr double start_speed = 1e-9;  // [m/s] [rad/s], in addition

// Whether the joints of the scene leave all bodies where the scene has them.
bool keeps_poses(const scene::Mbd& mbd) {
  if (mbd.start == scene::Start::equilibrium) return false;
  // Bodies and the ground that joints connect have the same root; the ground is the last.
  std::vector<std::size_t> root(mbd.bodies.size() + 1);
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto root_of = [&](BodyId body) {
    std::size_t at = body == ground ? mbd.bodies.size() : body.value;
    while (root[at] != at) at = root[at];
    return at;
  };
  for (const scene::Joint& joint : mbd.joints) {
    if (joint.motion || joint.child_position || joint.cut || joint.type == scene::JointType::distance)
      return false;
    const std::size_t parent = root_of(joint.parent), child = root_of(joint.child);
    if (parent == child) return false;  // a loop
    root[child] = parent;
  }
  return true;
}

std::string state_text(Vec3d v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}
std::string state_text(const Quat& q) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g}, {:.6g})", q.w, q.x, q.y, q.z);
}

[[noreturn]] void refuse_start(const std::string& problem) {
  throw Error(ErrorCode::protocol, problem, "mbd_server",
              "use a multibody participant that starts in the state of the scene: tandem conform --role mbd "
              "--check start_state");
}

}  // namespace

StartOfBodies::StartOfBodies(const scene::Scene& scene)
    : bodies_(scene.mbd ? scene.mbd->bodies : std::vector<scene::Body>{}),
      has_walls_(bodies_.size()),
      pose_known_(bodies_.size()),
      twist_known_(bodies_.size(), true) {
  if (!scene.mbd) return;
  if (scene.mbd->start == scene::Start::equilibrium) twist_known_.assign(bodies_.size(), false);
  for (const scene::Joint& joint : scene.mbd->joints)
    for (const BodyId body : {joint.parent, joint.child})
      if (body != ground) twist_known_[body.value] = false;
  const bool all = keeps_poses(*scene.mbd);
  for (std::size_t b = 0; b < bodies_.size(); ++b) pose_known_[b] = all || twist_known_[b];
  for (const scene::Wall& wall : scene.walls())
    if (wall.body != ground) has_walls_[wall.body.value] = true;
}

void StartOfBodies::expect_state(std::uint32_t index, const Pose& pose, const Twist& twist) const {
  const scene::Body& body = bodies_[index];
  const StateDifference d = difference(pose, twist, body.pose, body.twist, gyration(body), 0);
  const auto refuse_value = [&](const char* what, const std::string& value, const char* unit,
                                const std::string& expected) {
    refuse_start(fmt::format("body '{}' starts with the {} {}{}, and the scene gives it {}{}", body.name,
                             what, value, unit, expected, unit));
  };
  if (pose_known_[index]) {
    if (!(d.position <= start_share * (gyration(body) + norm(body.pose.p_WB))))
      refuse_value("position", state_text(pose.p_WB), " m", state_text(body.pose.p_WB));
    if (!(d.rotation <= start_share))
      refuse_value("orientation", state_text(pose.q_WB), "", state_text(body.pose.q_WB));
  }
  if (twist_known_[index]) {
    if (!(d.speed <= start_speed + start_share * norm(body.twist.v_WB)))
      refuse_value("velocity", state_text(twist.v_WB), " m/s", state_text(body.twist.v_WB));
    if (!(d.spin <= start_speed + start_share * norm(body.twist.w_WB)))
      refuse_value("angular velocity", state_text(twist.w_WB), " rad/s", state_text(body.twist.w_WB));
  }
}

void StartOfBodies::expect(const std::vector<protocol::BodyMotion>& boundary) const {
  std::vector<bool> sent(bodies_.size());
  for (const protocol::BodyMotion& motion : boundary) {
    if (motion.body >= bodies_.size() || !has_walls_[motion.body])
      refuse_start(
          fmt::format("the answer to configure has the motion of body {}, which has no walls", motion.body));
    sent[motion.body] = true;
    expect_state(motion.body, motion.begin_pose, motion.begin_twist);
    expect_state(motion.body, motion.end_pose, motion.end_twist);
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    if (has_walls_[b] && !sent[b])
      refuse_start(fmt::format("the answer to configure lacks the motion of body '{}', which has walls",
                               bodies_[b].name));
}

void StartOfBodies::expect(const std::vector<protocol::BodyState>& bodies) const {
  for (const protocol::BodyState& state : bodies)
    if (state.body < bodies_.size()) expect_state(state.body, state.pose, state.twist);
}

}  // namespace tandem::launch
