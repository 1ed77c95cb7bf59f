// What the outside sees of a state: bodies, joints with their reactions, energy. All from the kinematics of
// the last residual().
#pragma once

#include <vector>

#include "mbd_server/solve/tree_dynamics.hpp"

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
  double q = 0, rate = 0;  // revolute and prismatic; else 0
  // Everything that the parent passes to the child through the joint: constraint, drive, damping and
  // rotational springs. About the joint point, world axes. Zero at a free joint.
  Wrench reaction;
};

// Computes the reactions of all joints, fixed ones inside merged bodies included: the sum of inertia forces
// less applied forces of everything outboard.
class JointObserver {
 public:
  explicit JointObserver(const Model& model)
      : model_(model), carried_(model.bodies.size()), joints_(model.joints.size()) {}
  const std::vector<JointObservation>& observe(const State& state, const std::vector<LinkMotion>& links);

 private:
  const Model& model_;
  std::vector<Vector6d> carried_;  // by the joint of each body, about the world's origin (bodies)
  std::vector<JointObservation> joints_;
};

// Kinetic, of gravity and of springs [J].
double energy(const Model& model, const std::vector<LinkMotion>& links);

// Largest departure of a link's quaternion from unit length [-]: all that joint coordinates leave to be
// violated.
double constraint_violation(const std::vector<LinkMotion>& links);

}  // namespace tandem::mbd
