// Outputs of a state: motion of bodies, joints with their reactions, energy. All of them use the kinematics
// of the last residual().
#pragma once

#include <string>
#include <vector>

#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

// Motion of a body's frame in the world.
struct BodyMotionState {
  Pose pose;
  Twist twist;
  Vec3d a;      // of the centre of mass [m/s2]
  Vec3d alpha;  // [rad/s2]
};
BodyMotionState observe_body(const Model& model, const std::vector<LinkMotion>& links, int body);

struct JointObservation {
  // Coordinate and rate of revolute, prismatic and screw joints, else 0; of cut revolute joints in (-pi, pi].
  double q = 0, rate = 0;
  // Whole wrench that the parent transmits to the child through the joint: constraint, drive, damping and
  // rotational springs. About the joint point, world axes. Zero at a free joint.
  Wrench reaction;
};

// Computes the reactions of all joints, including fixed joints inside merged bodies: the sum of the inertia
// forces less the applied forces of everything outboard.
class JointObserver {
 public:
  explicit JointObserver(const Model& model);
  const std::vector<JointObservation>& observe(const State& state, const std::vector<LinkMotion>& links);

 private:
  class Receiver;
  void apply(int body, const Vector6d& wrench);
  void apply_forces(const State& state, const std::vector<LinkMotion>& links);
  void observe_cut(const SceneJoint& joint, const std::vector<LinkMotion>& links,
                   JointObservation& observed) const;
  static Vector6d wrench(const Closure& closure, const State& state, const std::vector<LinkMotion>& links);

  const Model& model_;
  // Wrench transmitted by the joint of each body, about the world's origin (bodies).
  std::vector<Vector6d> carried_;
  std::vector<JointObservation> joints_;
  std::vector<std::unique_ptr<ForceElement>> forces_;  // copies of those of the model (forces)
};

// Kinetic energy, potential energy of gravity (zero at the origin), energy of springs, bushings, stops and
// compressed oil [J].
double energy(const Model& model, const State& state, const std::vector<LinkMotion>& links);
// Energy that contacts between bodies store, a part of it [J].
double contact_energy(const Model& model, const State& state, const std::vector<LinkMotion>& links);
// The same without the kinetic energy [J].
double potential_energy(const Model& model, const State& state, const std::vector<LinkMotion>& links);

// A motor or cylinder.
struct ElementObservation {
  std::string name;
  bool hydraulic = false;
  double s = 0, rate = 0;                 // coordinate of the joint, or stroke [rad] or [m]
  double force = 0;                       // on the coordinate, or pushing the ends apart [N m] or [N]
  double power = 0;                       // of that force [W]
  double pressure_a = 0, pressure_b = 0;  // [Pa]
  double flow_a = 0, flow_b = 0;          // into the chambers through the valve [m3/s]
};
std::vector<ElementObservation> observe_elements(const Model& model, const State& state,
                                                 const std::vector<LinkMotion>& links);

// Sum of the sizes of all external forces on the machine and of its inertia forces: weights, inertia forces,
// loads of particles and scene, springs, bushings, forces on joints; torques are divided by the size of the
// machine [N]. A joint of a determinate machine transmits a part of this, times the leverage of the machine.
double force_scale(const Model& model, const State& state, const std::vector<LinkMotion>& links);

// Largest residual of a closure's equations, with positions relative to the length of the loop and directions
// in rad, and largest deviation of a link's quaternion from unit length.
double constraint_violation(const Model& model, const MachineSystem& system);

}  // namespace tandem::mbd
