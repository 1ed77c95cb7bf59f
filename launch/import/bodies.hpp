// Links of a URDF model as bodies of a scene.
#pragma once

#include <urdf_model/model.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "common/math/rotation.hpp"

namespace tandem::launch {

// Pose of a link at zero joint coordinates, and the body that it belongs to.
struct LinkFrame {
  Pose pose;         // of the link's frame in the world
  std::string body;  // the link itself, the link that it is fixed to, or "ground"
  Vec3d p_WB;        // origin of that body's frame, its centre of mass, in the world [m]; 0 for the ground
  Quat q_WB;         // its orientation
};
using LinkFrames = std::map<std::string, LinkFrame>;  // by link

LinkFrames place_links(const urdf::ModelInterface& model, bool free_root, const std::string& file);

nlohmann::ordered_json bodies_of(const urdf::ModelInterface& model, const LinkFrames& frames,
                                 const std::string& file);

Vec3d vector(const urdf::Vector3& v);
Pose pose_of(const urdf::Pose& pose);
// Pose of C in A from those of B in A and of C in B.
Pose operator*(const Pose& AB, const Pose& BC);

nlohmann::ordered_json list(Vec3d v);
nlohmann::ordered_json list(Quat q);

}  // namespace tandem::launch
