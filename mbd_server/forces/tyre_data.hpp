// The data of a tyre on a wheel, see scene::Tyre.
#pragma once

#include <memory>
#include <string>

#include "mbd_server/model/point_on_body.hpp"
#include "mbd_server/model/road.hpp"

namespace tandem::mbd {

// The force of a road on a wheel, see scene::Tyre. Its first-order states are the deflections of the
// tread (forces/tyre.hpp).
struct TyreOnLink {
  std::string name;
  PointOnBody centre;                             // of the wheel
  Vector3d axle = Vector3d::UnitY();              // link axes
  Vector3d normal = Vector3d::UnitZ();            // of a plane road; of another upwards; world axes
  double height = 0;                              // of a plane along the normal, from Model::origin [m]
  std::shared_ptr<const Road> road{};             // null: the plane
  double radius = 0, stiffness = 0, damping = 0;  // [m], [N/m], [N s/m]
  double friction = 0;
  double slip_stiffness = 0, cornering_stiffness = 0;  // over the load
  double relaxation_x = 0, relaxation_y = 0;           // [m]
  double rolling_resistance = 0;
  double patch = 0;  // length of contact [m]
  int state = 0;     // the first of two
  int account = none;
};

}  // namespace tandem::mbd
