// Shapes of bodies that touch, and the pairs of them that may. A contact has one or more points: the corners
// of a polytope on a plane, or the one point where two round shapes are nearest.
#pragma once

#include <string>
#include <vector>

#include "mbd_server/model/indices.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

// All in the frame of the link.
struct ContactShape {
  enum class Kind { plane, sphere, capsule, box, hull } kind = Kind::sphere;
  std::string name;  // shape "tread" of body "wheel"
  int body = none;   // body of the scene; none: ground
  LinkIndex link = 0;
  double radius = 0;                      // of sphere and capsule [m]
  Vector3d centre = Vector3d::Zero();     // of sphere and box; a point of the plane [m]
  Matrix3d axes = Matrix3d::Identity();   // of the box, as columns; the last is the plane's normal [-]
  Vector3d half_size = Vector3d::Zero();  // of the box [m]
  std::vector<Vector3d> points{};         // corners of box and hull; ends of the capsule's axis [m]
};

struct ContactLaw {
  bool hertz = false;           // force over depth to the power 3/2, else linear
  double stiffness = 0;         // [N/m^1.5] or [N/m]
  double tangential_ratio = 0;  // tangential over normal stiffness [-]
  double damping_number = 0;    // of the restitution, see forces/joint_force.hpp [-]
  double friction = 0;          // Coulomb coefficient [-]
};

// Shapes a and b on different links, of which one is not the ground. b is the plane, where there is one;
// else a is a sphere.
struct ContactPair {
  int a = none, b = none;  // index in Model::contact_shapes
  ContactLaw law;
  int first = 0, count = 1;  // of its points, columns of State::contacts
};

}  // namespace tandem::mbd
