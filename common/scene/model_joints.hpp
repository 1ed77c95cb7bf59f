// Bodies, joints and couplers of a machine.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/ids.hpp"
#include "common/math/rotation.hpp"
#include "common/scene/model_motion.hpp"

namespace tandem::scene {

struct Body {
  std::string name;
  double mass = 0;                  // [kg] > 0
  std::array<double, 6> inertia{};  // about the centre of mass, body axes: xx yy zz xy xz yz [kg m2]
  Pose pose;                        // at the start
  Twist twist;                      // at the start; used for free bodies, others follow from their joints
  // Mass, inertia and centre of mass are not known yet: they follow from the shapes, once the meshes are
  // there (common/scene/shape_mass.hpp). Until then `pose` is that of the frame in which the shapes are.
  bool from_shapes = false;
  std::optional<Vec3d> colour = {};  // in pictures: red, green, blue from 0 to 1
  // Names of the assemblies of a CAD program that it is in, from the outermost, with / between them.
  std::string assembly = {};
};

enum class JointType {
  fixed,
  revolute,
  prismatic,
  spherical,
  free,
  cylindrical,
  universal,
  planar,
  screw,
  distance,  // two points at a constant distance: a constraint, never part of the tree
};

// A stiff one-sided spring beyond each limit: force stiffness d (1 + damping dd/dt) at depth d.
struct Limits {
  double lower = 0, upper = 0;             // [rad] or [m]
  double stiffness = 0;                    // [N m/rad] or [N/m]
  double damping = 0;                      // [s/rad] or [s/m]
  std::optional<double> restitution = {};  // of the rate, instead of the damping, which then follows from it
};

// Coulomb friction: regularised, -force tanh(rate / slip); or with stiction, which holds a joint at rest.
struct Friction {
  double force = 0;  // of a sliding joint [N m] or [N]
  double slip = 0;   // rate at which three quarters of the force act [rad/s] or [m/s]
  // Instead of `slip`: force up to which the joint stays at rest, at least `force` [N m] or [N].
  std::optional<double> breakaway = {};
};

struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  BodyId parent = ground, child;
  Vec3d position;                       // of the joint, world at the start [m]
  std::optional<Vec3d> child_position;  // of the joint on the child; absent: the same point
  Vec3d axis{0, 0, 1};                  // world at the start, unit; planar: normal of the plane
  Vec3d axis2{1, 0, 0};                 // universal: second axis, fixed in the child, across the first
  double pitch = 0;                     // screw: travel per angle [m/rad]
  double length = 0;                    // distance [m]
  double rate = 0;                   // initial coordinate rate [rad/s] or [m/s]; revolute, prismatic, screw
  double damping = 0;                // [N m s/rad] or [N s/m]; on all freedoms of the joint
  bool cut = false;                  // close a loop at this joint, instead of the automatic choice
  std::optional<Limits> limits;      // revolute and prismatic only
  std::optional<Friction> friction;  // revolute and prismatic only
  std::optional<Motion> motion;      // prescribed coordinate [rad] or [m]; revolute and prismatic only
};
// The coordinate of a revolute, prismatic or screw joint is zero in the pose that the file gives to the
// bodies. A body that no joint connects with the ground is free, or depends on a free body.

// A force law as a table: monotone cubic through the points, straight lines outside.
struct ForceTable {
  std::vector<double> arguments, values;
};

// Which coordinate of a cylindrical joint; other joints have one.
enum class JointCoordinate { angle, displacement };
struct CoupledJoint {
  JointId joint;
  JointCoordinate coordinate = JointCoordinate::angle;
  double factor = 1;
};
// A cam: one coordinate as a function of another, through points, with continuous curvature.
struct CamTable {
  std::vector<double> arguments, values;
  std::optional<double> period;  // of the argument; the table covers one
};

// Couples coordinates of joints: q_b = ratio q_a, or sum of factor q = 0, or q_b = f(q_a) - f(0).
enum class CouplerType { gear, rack_and_pinion, belt, linear, cam };
struct Coupler {
  std::string name;
  CouplerType type = CouplerType::gear;
  JointId joint_a, joint_b;
  double ratio = 1;                   // [-], rack and pinion [m/rad]
  std::vector<CoupledJoint> terms{};  // linear: two or more; cam: a, b
  std::optional<CamTable> table{};    // cam
};

}  // namespace tandem::scene
