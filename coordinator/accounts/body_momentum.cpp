#include "coordinator/accounts/body_momentum.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <variant>

#include "common/scene/force_parts.hpp"
#include "coordinator/watch/motion_watch.hpp"

namespace tandem::launch {
namespace {

// Share of the momentum itself that counts as impulse in each window: a body that nothing acts on keeps its
// momentum to rounding.
constexpr double rounding_share = 1e-9;
// Share of the forces, and of their moments at the size of the body, that counts as impulse: loads that
// cancel in the free direction leave their rounding.
constexpr double cancelling_share = 1e-6;

// Bodies on which a force element acts, and joints.
struct Driven {
  std::set<std::uint32_t> bodies, joints;
};
Driven driven_by_forces(const scene::Mbd& mbd) {
  Driven driven;
  const scene::AttachedTo attached = scene::attached_to(mbd);
  for (const BodyId body : attached.bodies) driven.bodies.insert(body.value);
  for (const JointId joint : attached.joints) driven.joints.insert(joint.value);
  for (const scene::Coupler& coupler : mbd.couplers) {
    if (coupler.terms.empty()) driven.joints.insert({coupler.joint_a.value, coupler.joint_b.value});
    for (const scene::CoupledJoint& term : coupler.terms) driven.joints.insert(term.joint.value);
  }
  return driven;
}

// Whether other bodies push the body by contacts.
bool touches_bodies(const scene::Scene& scene, BodyId body) {
  return scene.contact && std::ranges::any_of(scene.shapes, [&](const scene::Shape& shape) {
           return shape.use == scene::ShapeUse::contact && shape.body == body;
         });
}

bool moves_freely(const scene::Joint& joint) {
  const bool one_axis = joint.type == scene::JointType::revolute || joint.type == scene::JointType::prismatic;
  return one_axis && joint.parent == ground && !joint.child_position && joint.damping == 0 && !joint.cut &&
         !joint.limits && !joint.friction && !joint.motion;
}

double ratio_of(double part, double whole) {
  return part > 0 ? part / whole : 0;
}

}  // namespace

double BodyMomentum::Sums::linear() const {
  return ratio_of(residual, impulse);
}
double BodyMomentum::Sums::angular() const {
  return ratio_of(angular_residual, angular_impulse);
}

BodyMomentum::BodyMomentum(const scene::Scene& scene) : gravity_(scene.gravity) {
  if (!scene.mbd) return;
  const scene::Mbd& mbd = *scene.mbd;
  const Driven driven = driven_by_forces(mbd);
  for (const scene::Wall& wall : scene.walls()) {
    const std::uint32_t index = wall.body.value;
    if (wall.body == ground || driven.bodies.contains(index)) continue;
    Watched watched{mbd.bodies[index], {}, touches_bodies(scene, wall.body)};
    bool known = true;
    for (std::uint32_t j = 0; j < mbd.joints.size(); ++j) {
      const scene::Joint& joint = mbd.joints[j];
      if (joint.child != wall.body && joint.parent != wall.body) continue;
      if (joint.type == scene::JointType::free && joint.parent == ground) continue;
      known = known && !watched.joint && joint.child == wall.body && moves_freely(joint) &&
              !driven.joints.contains(j);
      watched.joint = joint;
    }
    // Within a window the lever of a contact about a hinge is not known.
    if (watched.touches && watched.joint && watched.joint->type == scene::JointType::revolute) known = false;
    if (known) watched_.emplace(index, watched);
  }
}

void BodyMomentum::record(const Exchange& exchange) {
  waiting_.clear();
  bodies_ = exchange.motion.bodies.size();
  for (std::size_t k = 0; k < bodies_; ++k) {
    const protocol::BodyMotion& motion = exchange.motion.bodies[k];
    const auto found = watched_.find(motion.body);
    if (found == watched_.end()) continue;
    const auto sent = std::ranges::find(exchange.applied.bodies, motion.body, &protocol::BodyLoad::body);
    const Wrench load = sent == exchange.applied.bodies.end() ? Wrench{} : sent->mean;
    if (found->second.touches)
      waiting_.push_back({motion, load, exchange.motion.window.length(), k});
    else
      record(found->second, motion, load, exchange.motion.window.length());
  }
}

void BodyMomentum::record(const Watched& watched, const protocol::BodyMotion& motion, const Wrench& load,
                          double H) {
  Sums& sums = sums_[motion.body];
  if (!watched.joint)
    record_free(watched, motion, load, H, sums);
  else if (watched.joint->type == scene::JointType::revolute)
    record_hinge(watched, motion, load, H, sums);
  else
    record_slide(watched, motion, load, H, sums);
}

// The impulse of contacts in the window is the change since the last frame.
void BodyMomentum::observe(const protocol::BodiesFrame& frame) {
  const std::size_t size = frame.contacts.size();
  for (const Waiting& w : waiting_) {
    if (size != 6 * bodies_ + 1) break;  // the participant has no such account
    const auto change = [&](std::size_t i) {
      const std::size_t at = 6 * w.index + i;
      return (frame.contacts[at] - (contacts_.size() == size ? contacts_[at] : 0)) / w.length;
    };
    const Wrench together{
        {w.load.force.x + change(3), w.load.force.y + change(4), w.load.force.z + change(5)},
        {w.load.torque.x + change(0), w.load.torque.y + change(1), w.load.torque.z + change(2)}};
    record(watched_.at(w.motion.body), w.motion, together, w.length);
  }
  waiting_.clear();
  contacts_ = frame.contacts;
}

void BodyMomentum::record_free(const Watched& watched, const protocol::BodyMotion& motion, const Wrench& load,
                               double H, Sums& sums) const {
  const double mass = watched.body.mass;
  const Vec3d change = mass * (motion.end_twist.v_WB - motion.begin_twist.v_WB);
  sums.residual += norm(change - H * (load.force + mass * gravity_));
  sums.impulse +=
      H * (norm(load.force) + mass * norm(gravity_)) + rounding_share * mass * norm(motion.begin_twist.v_WB);
  const Vec3d begin = angular_momentum(watched.body, motion.begin_pose, motion.begin_twist);
  const Vec3d end = angular_momentum(watched.body, motion.end_pose, motion.end_twist);
  // What turns with the body is a torque in its axes, which the solver integrates as it does the load.
  const double gyroscopic =
      std::max(norm(cross(motion.begin_twist.w_WB, begin)), norm(cross(motion.end_twist.w_WB, end)));
  sums.angular_residual += norm(end - begin - H * load.torque);
  const double forces = norm(load.force) + mass * norm(gravity_);
  sums.angular_impulse += H * (norm(load.torque) + gyroscopic) + rounding_share * norm(begin) +
                          cancelling_share * H * forces * gyration(watched.body);
}

// Angular momentum about the axis of the hinge.
void BodyMomentum::record_hinge(const Watched& watched, const protocol::BodyMotion& motion,
                                const Wrench& load, double H, Sums& sums) const {
  const Vec3d axis = watched.joint->axis, point = watched.joint->position;
  const double mass = watched.body.mass;
  const auto about_axis = [&](const Pose& pose, const Twist& twist) {
    return dot(axis,
               angular_momentum(watched.body, pose, twist) + mass * cross(pose.p_WB - point, twist.v_WB));
  };
  const double begin = about_axis(motion.begin_pose, motion.begin_twist);
  const double end = about_axis(motion.end_pose, motion.end_twist);
  const Vec3d arm = 0.5 * (motion.begin_pose.p_WB + motion.end_pose.p_WB) - point;
  const double torque = dot(axis, load.torque), by_force = dot(axis, cross(arm, load.force)),
               by_weight = mass * dot(axis, cross(arm, gravity_));
  sums.angular_residual += std::abs(end - begin - H * (torque + by_force + by_weight));
  const double moments =
      norm(load.torque) + (norm(load.force) + mass * norm(gravity_)) * (norm(arm) + gyration(watched.body));
  sums.angular_impulse += H * (std::abs(torque) + std::abs(by_force) + std::abs(by_weight)) +
                          rounding_share * std::abs(begin) + cancelling_share * H * moments;
}

void BodyMomentum::record_slide(const Watched& watched, const protocol::BodyMotion& motion,
                                const Wrench& load, double H, Sums& sums) const {
  const Vec3d axis = watched.joint->axis;
  const double mass = watched.body.mass, by_load = dot(axis, load.force),
               by_weight = mass * dot(axis, gravity_);
  const double change = mass * dot(axis, motion.end_twist.v_WB - motion.begin_twist.v_WB);
  sums.residual += std::abs(change - H * (by_load + by_weight));
  sums.impulse += H * (std::abs(by_load) + std::abs(by_weight)) +
                  rounding_share * mass * norm(motion.begin_twist.v_WB) +
                  cancelling_share * H * (norm(load.force) + mass * norm(gravity_));
}

void BodyMomentum::save_or_restore(Archive& archive, std::size_t bodies) {
  archive("body_momentum", sums_);
  archive("body_momentum/contacts", contacts_);
  for (const double value : contacts_)
    archive.expect(std::isfinite(value), "body_momentum/contacts", "a value is not finite");
  for (const auto& [index, sums] : sums_) {
    archive.expect(index < bodies, "body_momentum.keys", "there is no such body");
    for (const double sum : {sums.residual, sums.impulse, sums.angular_residual, sums.angular_impulse})
      archive.expect(std::isfinite(sum) && sum >= 0, "body_momentum.items",
                     "a sum is not finite, or negative");
  }
}

}  // namespace tandem::launch
