// The multibody system as the solver sees it: immutable, made once from a scene (build.hpp).
//
// The spanning tree is a list of links, parent before child; link 0 is the ground. A link is a rigid body
// moved by one elementary joint: all scene bodies that fixed joints weld together, or nothing at all between
// two elementary joints of one scene joint. At zero coordinates every link frame is parallel to the world,
// with its origin on its joint; that is the pose which the scene file gives.
#pragma once

#include <string>
#include <vector>

#include "common/ids.hpp"
#include "common/scene/model.hpp"
#include "mbd_server/joints/elementary_joint.hpp"
#include "mbd_server/joints/motion_function.hpp"
#include "mbd_server/solve/spatial.hpp"

namespace tandem::mbd {

using LinkIndex = int;
inline constexpr int none = -1;

struct Link {
  LinkIndex parent = 0;
  Elementary kind = Elementary::revolute;
  Vector3d offset = Vector3d::Zero();  // origin from the parent's origin at zero coordinates, parent axes [m]
  Vector3d axis = Vector3d::UnitZ();   // revolute and prismatic: link axes [-]
  int q = none, u = none;              // first entry in the vectors of the state; none: prescribed
  int motion = none;                   // index in Model::motions; none: free to move
  double mass = 0;                     // of all bodies welded to this link [kg]; 0: a link between two joints
  Vector3d com = Vector3d::Zero();     // centre of mass, link frame [m]
  Matrix3d inertia = Matrix3d::Zero();  // about com, link axes [kg m2]

  int freedoms() const { return motion == none ? mbd::freedoms(kind) : 0; }
};

// A body of the scene, fixed to a link.
struct BodyOnLink {
  LinkIndex link = 0;
  Vector3d p_LB = Vector3d::Zero();  // centre of mass, link frame [m]
  Quaterniond q_LB = Quaterniond::Identity();
  double mass = 0;                      // [kg]
  Matrix3d inertia = Matrix3d::Zero();  // about the centre of mass, link axes [kg m2]
  int parent = none, joint = none;  // body and joint of the scene that it hangs on; none: the ground, free
};

// A joint of the scene.
struct SceneJoint {
  scene::JointType type = scene::JointType::fixed;
  int child = none;                  // body of the scene
  LinkIndex link = 0;                // the link that carries the child
  Vector3d p_LJ = Vector3d::Zero();  // joint point, frame of that link [m]
};

struct PointOnBody {
  int body = none;  // body of the scene; none: ground
  LinkIndex link = 0;
  Vector3d p_LP = Vector3d::Zero();  // link frame [m]
};

// Force along the line between two points, see scene::SpringDamper.
struct Spring {
  std::string name;
  PointOnBody a, b;
  double stiffness = 0, damping = 0, length = 0;  // [N/m] [N s/m] [m]
};

// Force or torque on one joint coordinate: -stiffness (q - rest) - damping u.
struct JointForce {
  LinkIndex link = 0;
  double stiffness = 0, damping = 0, rest = 0;  // [N m/rad or N/m] [N m s/rad or N s/m] [rad or m]
};

struct Model {
  Vector3d gravity = Vector3d::Zero();  // [m/s2]
  std::vector<Link> links;              // parent before child (links); [0] is the ground
  std::vector<MotionFunction> motions;
  int coordinates = 0, freedoms = 0;  // lengths of q and u
  VectorXd scale;  // what counts as a large change of each coordinate: 1 rad, the system's size [m]

  std::vector<BodyOnLink> bodies;  // in the order of the scene (bodies)
  std::vector<SceneJoint> joints;  // in the order of the scene (joints)
  std::vector<int> outward;        // bodies, parent before child
  std::vector<int> boundary;       // bodies that carry walls of the particle side, ascending
  std::vector<Spring> springs;
  std::vector<JointForce> joint_forces;

  // Inertia forces on the coordinates depend on the rates; otherwise that part of the iteration matrix is
  // left out.
  bool gyroscopic = true;
  bool damped = false;  // some damper is present
  bool driven = false;  // some coordinate is prescribed
  int welded = 0;       // bodies that cost nothing because they are part of another link or the ground

  std::vector<std::string> coordinate_names;  // for messages: joint "hinge" of body "wheel" (freedoms)
};

}  // namespace tandem::mbd
