// A force or torque of given direction on a body, see scene::BodyLoad.
#pragma once

#include <optional>

#include "mbd_server/forces/force_element.hpp"

namespace tandem::mbd {

struct LoadOnLink {
  PointOnBody at;
  Vector3d direction;  // link axes if the load follows the link, else world axes
  bool torque = false, follows = false;
  int drive = none;                        // its size over time, index in Model::drives
  std::optional<SizeOverJoint> over = {};  // instead of `drive`
  int account = none;
};

std::shared_ptr<const ForceElement> make_force(LoadOnLink load);

}  // namespace tandem::mbd
