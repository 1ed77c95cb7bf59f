// Finds the reactions that rigid-body mechanics does not determine: where a door has more hinges than it
// needs, only their elasticity decides which of them carry it. The solver gives the smallest of all sets of
// multipliers with the same effect; this file finds the components in which other sets differ.
#pragma once

#include <cstdint>
#include <vector>

#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

// Bits of the components of a reaction: force x, y, z, torque x, y, z in world axes.
using Components = std::uint32_t;

class UndeterminedReactions {
 public:
  explicit UndeterminedReactions(const Model& model);  // the model must outlive this object

  // Returns the components of each joint's reaction that are not determined (joints of the scene), at the
  // state of the system's last residual(); `redundant`: whether equations that are not idle may depend on
  // each other there. The system is then factorised. Does not allocate.
  const std::vector<Components>& find(MachineSystem& system, bool redundant);

 private:
  void add_idle(const Closure& closure, const Equation& idle, const std::vector<LinkMotion>& links);
  void add_null_vector(const std::vector<LinkMotion>& links);
  void act(const SceneJoint& joint, const EquationValue& e, double lambda, Vector6d& passed);
  Vector6d about_joint(int joint, const Vector6d& wrench, const std::vector<LinkMotion>& links) const;
  void mark(int joint, const Vector6d& reaction, double largest);

  const Model& model_;
  std::vector<std::vector<int>> loops_;  // joints of the tree between the ends of each closure (closures)
  std::vector<int> joint_of_;            // joint of the scene (closures); none: a coupler
  std::vector<Vector6d> carried_;  // wrench transmitted by the joint of each body, about the origin (bodies)
  std::vector<Vector6d> passed_;   // wrench transmitted by each joint to its child (joints)
  std::vector<Components> marks_;  // (joints)
  VectorXd lambda_, zero_;         // (equations), (freedoms)
};

// Names such as force.x and torque.z.
std::vector<const char*> component_names(Components components);

}  // namespace tandem::mbd
