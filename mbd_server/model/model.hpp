// The multibody system as the solver uses it: immutable, built once from a scene (build.hpp).
//
// The spanning tree is a list of links, parent before child; link 0 is the ground. A link is moved by one
// elementary joint. It is either a rigid body, which consists of all scene bodies that fixed joints weld
// together, or a massless link between two elementary joints of one scene joint. At zero coordinates, the
// pose that the scene file gives, every link frame is parallel to the world and has its origin at its joint.
// Joints that are not in the tree are closures: algebraic equations between two links.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/ids.hpp"
#include "common/scene/model.hpp"
#include "common/scene/motion_function.hpp"
#include "mbd_server/joints/elementary_joint.hpp"
#include "mbd_server/model/closure.hpp"
#include "mbd_server/model/contact.hpp"
#include "mbd_server/model/force_law.hpp"
#include "mbd_server/model/periodic_curve.hpp"
#include "mbd_server/model/point_on_body.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

using scene::CoordinateMotion;
using scene::MotionFunction;

struct Link {
  LinkIndex parent = 0;
  Elementary kind = Elementary::revolute;
  Vector3d offset = Vector3d::Zero();  // origin from the parent's origin at zero coordinates, parent axes [m]
  Vector3d axis = Vector3d::UnitZ();   // revolute, prismatic, screw: link axes [-]
  double pitch = 0;                    // screw [m/rad]
  int q = none, u = none;              // index of the first entry in the state's vectors; none: prescribed
  int motion = none;                   // index in Model::motions; none: free to move
  int account = none;                  // of the motion, see Model::accounts
  double mass = 0;  // of all bodies welded to this link [kg]; 0: a massless link between two joints
  Vector3d com = Vector3d::Zero();      // centre of mass, link frame [m]
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
  int inboard = none, joint = none;     // inboard body and joint of the scene; none: the ground, free
};

// A joint of the scene, in the tree or cut.
struct SceneJoint {
  scene::JointType type = scene::JointType::fixed;
  int parent = none, child = none;   // bodies of the scene; none: the ground
  bool reversed = false;             // in the tree, with the child inboard
  int closure = none;                // index in Model::closures; none: in the tree
  LinkIndex coordinate_link = none;  // of a tree joint with one freedom: the link whose coordinate it is
  LinkIndex link = 0;                // the link to which the child belongs
  Vector3d p_LJ = Vector3d::Zero();  // joint point, frame of that link [m]
};

// The size of a force as a function of a joint coordinate or its rate, see scene::JointFunction.
struct SizeOverJoint {
  LinkIndex link = 0;
  bool of_rate = false;
  PeriodicCurve curve;
};

// Force or torque on one joint coordinate.
struct JointForce {
  LinkIndex link = 0;
  double rest = 0;  // [rad or m]
  // Functions of the coordinate less rest, and of its rate; both act against their argument [N m or N].
  ForceLaw elastic, viscous;
  std::optional<scene::Limits> limits;
  double damping_number = 0;  // of limits with a restitution, see forces/joint_force.hpp
  int stop = none;  // column in State::stops, of limits on a free coordinate; none: there are no such limits
  std::optional<scene::Friction> friction;
  Signal share;         // of the friction that acts, of a brake; without a signal all of it
  bool brake = false;   // of a motor
  int stiction = none;  // index in State::sliding, of friction with a breakaway on a free coordinate
  int drive = none;     // index in Model::drives
  int input = none;     // index in State::inputs
  std::optional<SizeOverJoint> over = {};
  int account = none;  // of the joint's damping, friction and limits, or of the force
};

// Values that an input may have.
struct InputRange {
  int input = none;
  double lowest = 0, highest = 0;
  std::string of;  // in the user's words
};

class ForceElement;

struct Model {
  Vector3d gravity = Vector3d::Zero();  // [m/s2]
  std::vector<Link> links;              // parent before child (links); [0] is the ground
  std::vector<MotionFunction> motions;
  int coordinates = 0, freedoms = 0;  // lengths of q and u
  VectorXd scale;   // change of each coordinate that counts as large: 1 rad, or the system's size [m]
  double size = 1;  // of the system: about its largest extent [m]
  // All positions inside the solver are relative to this point of the world, which is near the machine:
  // relative to a remote origin they would lose digits [m].
  Vector3d origin = Vector3d::Zero();

  std::vector<Closure> closures;
  int equations = 0;              // of all closures: length of lambda
  std::vector<double> force_arm;  // divisor that turns a multiplier into a force: 1, or the size for a torque

  std::vector<BodyOnLink> bodies;  // in the order of the scene (bodies)
  std::vector<SceneJoint> joints;  // in the order of the scene (joints)
  std::vector<int> outward;        // bodies, inboard before outboard
  std::vector<int> boundary;       // bodies with walls of the particle side, ascending
  // Springs, bushings, ropes, loads, motors, cylinders, tyres, in the order of sums
  // (forces/force_element.hpp).
  std::vector<std::shared_ptr<const ForceElement>> forces;
  std::vector<JointForce> joint_forces;
  std::vector<int> stops;      // joint forces with limits on a free coordinate, index in joint_forces
  std::vector<int> stictions;  // joint forces with stiction on a free coordinate, likewise
  // Forces and torques of loads and actuators, and signals of elements over time; which of them are forces.
  std::vector<MotionFunction> drives;
  std::vector<bool> drive_is_force;
  int inputs = 0;  // number of values that a controller sets
  std::vector<InputRange> input_ranges;
  BodyContactModel contact;  // between bodies
  // Number of scene::elements_of(): each force, coupler, joint and output of contacts among them has an
  // index, its account, under which its work and its losses are recorded.
  int accounts = 0;
  VectorXd first_states;                 // of the elements, at the start (first-order states)
  VectorXd state_scale;                  // change of each that counts as large (first-order states)
  std::vector<std::string> state_names;  // for messages (first-order states)
  // Breaks of all functions of time after the start, ascending: no step contains one [s].
  std::vector<double> breaks;
  std::vector<int> held;  // first freedoms of the links whose rates the scene gives

  // Whether inertia forces on the coordinates depend on the rates; if not, the iteration matrix omits that
  // part.
  bool gyroscopic = true;
  bool damped = false;   // some damper or friction is present
  bool driven = false;   // some coordinate is prescribed
  bool powered = false;  // some force does work that is not stored: loads, actuators
  int welded = 0;        // bodies that cost nothing because they belong to another link or to the ground

  // Largest frequency of a harmonic motion, load or actuator; 0: there is none [1/s].
  double frequency = 0;

  std::vector<std::string> coordinate_names;  // for messages: joint "hinge" of body "wheel" (freedoms)
};

}  // namespace tandem::mbd
