// Points of bodies at which forces act, and the signals that forces follow.
#pragma once

#include "mbd_server/model/indices.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

struct PointOnBody {
  int body = none;  // body of the scene; none: ground
  LinkIndex link = 0;
  Vector3d p_LP = Vector3d::Zero();  // link frame [m]
};

// A value that a function of time or a controller gives.
struct Signal {
  int drive = none;  // index in Model::drives
  int input = none;  // index in State::inputs
};

}  // namespace tandem::mbd
