#include "coordinator/watch/joint_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coordinator/watch/rigid_body.hpp"

namespace tandem::launch {
namespace {

using scene::JointType;

constexpr double full_turn = 2 * std::numbers::pi;

// Twice the largest distance of bodies and joints from their centre; at least the size of a body.
double size_of_machine(const scene::Mbd& mbd) {
  std::vector<Vec3d> points;
  double size = 0;
  for (const scene::Body& body : mbd.bodies) {
    points.push_back(body.pose.p_WB);
    size = std::max(size, gyration(body));
  }
  for (const scene::Joint& joint : mbd.joints) points.push_back(joint.position);
  Vec3d centre;
  for (const Vec3d& point : points) centre += (1 / static_cast<double>(points.size())) * point;
  for (const Vec3d& point : points) size = std::max(size, 2 * norm(point - centre));
  return size;
}

// A unit vector across a unit vector.
Vec3d across(Vec3d n) {
  const Vec3d least = std::abs(n.x) <= std::abs(n.y) && std::abs(n.x) <= std::abs(n.z) ? Vec3d{1, 0, 0}
                      : std::abs(n.y) <= std::abs(n.z)                                 ? Vec3d{0, 1, 0}
                                                                                       : Vec3d{0, 0, 1};
  return normalized(cross(n, least));
}

double angle_between(Vec3d a, Vec3d b) {
  return 2 * std::asin(std::min(1.0, 0.5 * norm(a - b)));
}
Vec3d without(Vec3d v, Vec3d direction) {
  return v - dot(v, direction) * direction;
}

bool holds_points(JointType type) {
  return type == JointType::fixed || type == JointType::revolute || type == JointType::spherical ||
         type == JointType::universal;
}
bool slides_along_axis(JointType type) {
  return type == JointType::prismatic || type == JointType::cylindrical || type == JointType::screw;
}
bool holds_orientation(JointType type) {
  return type == JointType::fixed || type == JointType::prismatic;
}
bool holds_axis(JointType type) {
  return type == JointType::revolute || type == JointType::cylindrical || type == JointType::screw ||
         type == JointType::planar;
}
bool has_angle(JointType type) {
  return type == JointType::revolute || type == JointType::screw;
}

}  // namespace

std::string JointViolation::text() const {
  const std::string amount = fmt::format("{:.3g} {}", open, is_angle ? "rad" : "m");
  switch (fault) {
    case JointFault::distance:
      return "its two sides are " + amount + " apart";
    case JointFault::rotation:
      return "its two sides are rotated against each other by " + amount;
    case JointFault::motion:
      return "its coordinate is " + amount + " off its prescribed motion";
    case JointFault::coordinate:
      break;
  }
  return "the coordinate that the frame gives for it is " + amount + " off that of the bodies";
}

JointWatch::Side JointWatch::side_of(const scene::Mbd& mbd, BodyId body, Vec3d point,
                                     const scene::Joint& joint) {
  const Pose pose = body == ground ? Pose{} : mbd.bodies[body.value].pose;
  const Quat to_body = pose.q_WB.conjugate();
  const Vec3d axis = normalized(joint.axis);
  const Vec3d second = joint.type == JointType::universal ? normalized(joint.axis2) : across(axis);
  return {body, to_body.rotate(point - pose.p_WB), to_body.rotate(axis), to_body.rotate(second)};
}

JointWatch::JointWatch(const scene::Scene& scene) {
  if (!scene.mbd) return;
  const scene::Mbd& mbd = *scene.mbd;
  size_ = size_of_machine(mbd);
  for (std::uint32_t j = 0; j < mbd.joints.size(); ++j) {
    const scene::Joint& joint = mbd.joints[j];
    if (joint.type == JointType::free) continue;
    Watched watched{j, joint, side_of(mbd, joint.parent, joint.position, joint),
                    side_of(mbd, joint.child, joint.child_position.value_or(joint.position), joint),
                    std::nullopt};
    if (joint.motion) watched.motion.emplace(*joint.motion);
    joints_.push_back(std::move(watched));
  }
}

// None where the frame lacks the body. Frames have all bodies, in ascending order.
std::optional<JointWatch::Placed> JointWatch::placed(const Side& side,
                                                     const std::vector<protocol::BodyState>& bodies) {
  if (side.body == ground) return Placed{side.point, side.axis, side.across};
  const std::uint32_t index = side.body.value;
  const auto found = index < bodies.size() && bodies[index].body == index
                         ? bodies.begin() + index
                         : std::ranges::lower_bound(bodies, index, {}, &protocol::BodyState::body);
  if (found == bodies.end() || found->body != index) return std::nullopt;
  const Pose& pose = found->pose;
  return Placed{pose.p_WB + pose.q_WB.rotate(side.point), pose.q_WB.rotate(side.axis),
                pose.q_WB.rotate(side.across)};
}

void JointWatch::observe(const protocol::BodiesFrame& frame) {
  for (const Watched& watched : joints_) {
    const auto a = placed(watched.parent, frame.bodies), b = placed(watched.child, frame.bodies);
    if (a && b) judge(watched, *a, *b, frame);
  }
}

void JointWatch::judge(const Watched& watched, const Placed& a, const Placed& b,
                       const protocol::BodiesFrame& frame) {
  const scene::Joint& joint = watched.joint;
  const JointType type = joint.type;
  const double time = to_seconds(frame.time);
  const Vec3d d = b.point - a.point;
  const auto apart = [&](double open) { take(watched, JointFault::distance, false, std::abs(open), time); };
  const auto turned = [&](double open) { take(watched, JointFault::rotation, true, std::abs(open), time); };
  if (holds_points(type)) apart(norm(d));
  if (slides_along_axis(type)) apart(norm(without(d, a.axis)));
  if (type == JointType::planar) apart(dot(d, a.axis));
  if (type == JointType::distance) apart(norm(d) - joint.length);
  if (holds_orientation(type))
    turned(std::max(angle_between(a.axis, b.axis), angle_between(a.across, b.across)));
  if (holds_axis(type)) turned(angle_between(a.axis, b.axis));
  // The first axis is fixed in the parent, the second one in the child.
  if (type == JointType::universal) turned(std::asin(std::clamp(dot(a.axis, b.across), -1.0, 1.0)));

  if (!has_angle(type) && type != JointType::prismatic) return;
  // Angles are known up to full turns.
  const double travel = dot(d, a.axis),
               q = type == JointType::prismatic
                       ? travel
                       : std::atan2(dot(cross(a.axis, a.across), b.across), dot(a.across, b.across));
  if (type == JointType::screw && joint.pitch != 0)
    apart(std::remainder(travel - joint.pitch * q, full_turn * joint.pitch));
  const auto compare = [&](JointFault fault, double expected) {
    const double off = type == JointType::prismatic ? q - expected : std::remainder(q - expected, full_turn);
    take(watched, fault, has_angle(type), std::abs(off), time);
  };
  if (watched.motion) compare(JointFault::motion, watched.motion->at(time).value);
  const auto sent = std::ranges::lower_bound(frame.joints, watched.index, {}, &protocol::JointState::joint);
  if (sent != frame.joints.end() && sent->joint == watched.index) compare(JointFault::coordinate, sent->q);
}

void JointWatch::take(const Watched& watched, JointFault fault, bool is_angle, double open, double time) {
  const double share = is_angle ? open : open / size_;
  // Most violations are rounding; a map of those costs more than it tells.
  constexpr double rounding = 1e-6;
  if (share <= rounding) return;
  JointViolation& worst = violations_[watched.index];
  if (!(share <= worst.share)) worst = {share, open, time, fault, is_angle};
}

void JointWatch::save_or_restore(Archive& archive) {
  archive("joint_watch/violations", violations_);
  for (const auto& [index, v] : violations_) {
    archive.expect(
        std::ranges::any_of(joints_, [i = index](const Watched& watched) { return watched.index == i; }),
        "joint_watch/violations.keys", "there is no such joint");
    archive.expect(v.share >= 0 && v.open >= 0 && v.time >= 0 && std::isfinite(v.share + v.open + v.time) &&
                       v.fault <= JointFault::coordinate && v.is_angle <= 1,
                   "joint_watch/violations.items", "a figure is not finite, or negative");
  }
}

}  // namespace tandem::launch
