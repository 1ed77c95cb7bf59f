#include "launch/import/bodies.hpp"

#include <fmt/format.h>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void fail(const std::string& file, const std::string& element, const std::string& problem,
                       const std::string& hint) {
  throw Error(ErrorCode::scene, problem, file + ": " + element, hint);
}

Vec3d vector(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

// The inertia in the link's axes: R I R^T with the rotation of <inertial><origin>.
// URDF gives the elements of the matrix, as the scene does: xy is the element, not its negative.
std::array<double, 6> inertia_in_link(const urdf::Inertial& inertial) {
  const Mat3d R = pose_of(inertial.origin).q_WB.matrix();
  const Mat3d I{{{inertial.ixx, inertial.ixy, inertial.ixz},
                 {inertial.ixy, inertial.iyy, inertial.iyz},
                 {inertial.ixz, inertial.iyz, inertial.izz}}};
  const auto element = [&](int i, int j) { return dot(R.row[i], I * R.row[j]); };
  return {element(0, 0), element(1, 1), element(2, 2), element(0, 1), element(0, 2), element(1, 2)};
}

void place(const urdf::Link& link, const LinkFrame& parent, bool free_root, const std::string& file,
           LinkFrames& frames) {
  const std::string element = "link '" + link.name + "'";
  LinkFrame frame = parent;
  if (link.parent_joint)
    frame.pose = parent.pose * pose_of(link.parent_joint->parent_to_joint_origin_transform);
  const bool fixed = link.parent_joint ? link.parent_joint->type == urdf::Joint::FIXED : !free_root;
  if (link.inertial) {
    if (!(link.inertial->mass > 0))
      fail(file, element, fmt::format("the mass is {} kg", link.inertial->mass),
           "give a mass > 0, or leave out <inertial> where the link is only a frame");
    const Pose mass = frame.pose * pose_of(link.inertial->origin);
    frame.body = link.name;
    frame.p_WB = mass.p_WB;
    frame.q_WB = frame.pose.q_WB;
  } else if (!fixed) {
    fail(file, element,
         link.parent_joint ? "moves by joint '" + link.parent_joint->name + "' but has no <inertial>"
                           : std::string("is the free root but has no <inertial>"),
         "give it a mass and an inertia");
  }
  frames[link.name] = frame;
  for (const auto& child : link.child_links) place(*child, frame, free_root, file, frames);
}

std::string range(double lower, double upper, const char* unit) {
  return fmt::format("limits {:.6g} to {:.6g} {}", lower, upper, unit);
}

// What a joint of a scene does not have.
void note_rest(const urdf::Joint& joint, std::vector<std::string>& notes) {
  const auto note = [&](const std::string& what) { notes.push_back("joint '" + joint.name + "': " + what); };
  const bool turns = joint.type != urdf::Joint::PRISMATIC;
  if (joint.limits) {
    const urdf::JointLimits& limits = *joint.limits;
    if (joint.type != urdf::Joint::CONTINUOUS && (limits.lower != 0 || limits.upper != 0))
      note(range(limits.lower, limits.upper, turns ? "rad" : "m") + ": joints of a scene have no stops");
    if (limits.effort > 0)
      note(fmt::format("effort limit {:.6g} {}: there is no drive to limit", limits.effort,
                       turns ? "N m" : "N"));
    if (limits.velocity > 0)
      note(fmt::format("velocity limit {:.6g} {}: there is no drive to limit", limits.velocity,
                       turns ? "rad/s" : "m/s"));
  }
  if (joint.dynamics && joint.dynamics->friction > 0)
    note(fmt::format("friction {:.6g} {}: joints of a scene have no dry friction", joint.dynamics->friction,
                     turns ? "N m" : "N"));
  if (joint.mimic)
    note(fmt::format(
        "mimic of joint '{}' (multiplier {:.6g}, offset {:.6g}): joints of a scene are not coupled",
        joint.mimic->joint_name, joint.mimic->multiplier, joint.mimic->offset));
  if (joint.safety) note("<safety_controller>: a scene has no controllers");
  if (joint.calibration) note("<calibration>: a scene has no encoders");
}

const char* type_of(const urdf::Joint& joint, const std::string& file) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
      return "revolute";
    case urdf::Joint::PRISMATIC:
      return "prismatic";
    case urdf::Joint::FLOATING:
      return "free";
    case urdf::Joint::FIXED:
      return "fixed";
    default:
      fail(file, "joint '" + joint.name + "'", "a planar joint cannot be imported",
           "build it of two prismatic joints and a continuous one, with light links between them");
  }
}

}  // namespace

Pose pose_of(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  return {vector(pose.position), Quat{q.w, q.x, q.y, q.z}.normalized()};
}

Pose operator*(const Pose& AB, const Pose& BC) {
  return {AB.p_WB + AB.q_WB.rotate(BC.p_WB), (AB.q_WB * BC.q_WB).normalized()};
}

Json list(Vec3d v) {
  // No negative zeros: they come from rotations and only surprise the reader.
  return {v.x + 0.0, v.y + 0.0, v.z + 0.0};
}

Json list(Quat q) {
  return {q.w + 0.0, q.x + 0.0, q.y + 0.0, q.z + 0.0};
}

LinkFrames place_links(const urdf::ModelInterface& model, bool free_root, const std::string& file) {
  LinkFrames frames;
  place(*model.getRoot(), {.pose = {}, .body = "ground", .p_WB = {}, .q_WB = {}}, free_root, file, frames);
  return frames;
}

Json bodies_of(const urdf::ModelInterface& model, const LinkFrames& frames, const std::string& file) {
  Json bodies = Json::array();
  for (const auto& [name, link] : model.links_) {
    if (!link->inertial) continue;
    const LinkFrame& frame = frames.at(name);
    bodies.push_back({{"name", name},
                      {"mass", link->inertial->mass},
                      {"inertia", inertia_in_link(*link->inertial)},
                      {"position", list(frame.p_WB)},
                      {"orientation", list(frame.q_WB)}});
  }
  if (bodies.empty())
    throw Error(ErrorCode::scene, "no link has a mass", file, "give the links that move an <inertial>");
  return bodies;
}

Json joints_of(const urdf::ModelInterface& model, const LinkFrames& frames, bool free_root,
               const std::string& file, std::vector<std::string>& notes) {
  Json joints = Json::array();
  const urdf::Link& root = *model.getRoot();
  if (root.inertial && !free_root)
    joints.push_back({{"name", root.name + "_to_ground"},
                      {"type", "fixed"},
                      {"parent", "ground"},
                      {"child", root.name},
                      {"position", list(frames.at(root.name).pose.p_WB)}});
  for (const auto& [name, joint] : model.joints_) {
    const LinkFrame& child = frames.at(joint->child_link_name);
    const std::string type = type_of(*joint, file);
    note_rest(*joint, notes);
    if (child.body != joint->child_link_name) continue;  // the child is only a frame
    const std::string& parent = frames.at(joint->parent_link_name).body;
    Json entry{{"name", name},
               {"type", type},
               {"parent", parent},
               {"child", child.body},
               {"position", list(child.pose.p_WB)}};
    const double damping = joint->dynamics ? joint->dynamics->damping : 0;
    if (type == "revolute" || type == "prismatic") {
      const Vec3d axis = vector(joint->axis);
      if (!(norm(axis) > 0))
        fail(file, "joint '" + name + "'", "the axis is 0 0 0", "give the axis a direction");
      // The joint's frame is the child's at zero coordinates.
      entry["axis"] = list(child.pose.q_WB.rotate(normalized(axis)));
      if (damping != 0) entry["damping"] = damping;
    } else if (damping != 0) {
      notes.push_back(fmt::format("joint '{}': damping {:.6g}: a {} joint has none", name, damping, type));
    }
    joints.push_back(entry);
  }
  return joints;
}

}  // namespace tandem::launch
