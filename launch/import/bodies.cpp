#include "launch/import/bodies.hpp"

#include <fmt/format.h>

#include <vector>

#include "common/error.hpp"
#include "launch/import/urdf_file.hpp"

namespace tandem::launch {
namespace {

using Json = nlohmann::ordered_json;

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

LinkFrame place(const urdf::Link& link, const LinkFrame& parent, bool free_root, const std::string& file) {
  const std::string element = "link '" + link.name + "'";
  LinkFrame frame = parent;
  if (link.parent_joint)
    frame.pose = parent.pose * pose_of(link.parent_joint->parent_to_joint_origin_transform);
  const bool fixed = link.parent_joint ? link.parent_joint->type == urdf::Joint::FIXED : !free_root;
  if (link.inertial) {
    if (!(link.inertial->mass > 0))
      fail_on_urdf(file, element, fmt::format("the mass is {} kg", link.inertial->mass),
                   "give a mass > 0, or leave out <inertial> where the link is only a frame");
    const Pose mass = frame.pose * pose_of(link.inertial->origin);
    frame.body = link.name;
    frame.p_WB = mass.p_WB;
    frame.q_WB = frame.pose.q_WB;
  } else if (!fixed) {
    fail_on_urdf(file, element,
                 link.parent_joint ? "moves by joint '" + link.parent_joint->name + "' but has no <inertial>"
                                   : std::string("is the free root but has no <inertial>"),
                 "give it a mass and an inertia");
  }
  return frame;
}

}  // namespace

Vec3d vector(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Pose pose_of(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  return {vector(pose.position), Quat{q.w, q.x, q.y, q.z}.normalized()};
}

Pose operator*(const Pose& AB, const Pose& BC) {
  return {AB.p_WB + AB.q_WB.rotate(BC.p_WB), (AB.q_WB * BC.q_WB).normalized()};
}

Json list(Vec3d v) {
  // Rotations produce negative zeros, which would be confusing in the file.
  return {v.x + 0.0, v.y + 0.0, v.z + 0.0};
}

Json list(Quat q) {
  return {q.w + 0.0, q.x + 0.0, q.y + 0.0, q.z + 0.0};
}

LinkFrames place_links(const urdf::ModelInterface& model, bool free_root, const std::string& file) {
  LinkFrames frames;
  struct Next {
    const urdf::Link* link;
    LinkFrame parent;
  };
  std::vector<Next> open{{model.getRoot().get(), {.pose = {}, .body = "ground", .p_WB = {}, .q_WB = {}}}};
  while (!open.empty()) {
    const Next next = open.back();
    open.pop_back();
    const LinkFrame& frame = frames[next.link->name] = place(*next.link, next.parent, free_root, file);
    // A stack: the last child is pushed first, to keep the order of the file.
    for (auto child = next.link->child_links.rbegin(); child != next.link->child_links.rend(); ++child)
      open.push_back({child->get(), frame});
  }
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

}  // namespace tandem::launch
