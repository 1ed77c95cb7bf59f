#include "mbd_server/io/undetermined.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::mbd {
namespace {

// Components below this share of the largest one are round-off, or come from the rounding of the data.
constexpr double smallest = 1e-4;

}  // namespace

UndeterminedReactions::UndeterminedReactions(const Model& model)
    : model_(model),
      loops_(model.closures.size()),
      joint_of_(model.closures.size(), none),
      carried_(model.bodies.size()),
      passed_(model.joints.size()),
      marks_(model.joints.size(), 0),
      lambda_(VectorXd::Zero(model.equations)),
      zero_(VectorXd::Zero(model.freedoms)) {
  std::vector<int> depth(model.bodies.size(), 0);
  for (const int b : model.outward)
    if (model.bodies[b].inboard != none) depth[b] = depth[model.bodies[b].inboard] + 1;
  for (int j = 0; j < std::ssize(model.joints); ++j) {
    const int k = model.joints[j].closure;
    if (k == none) continue;
    joint_of_[k] = j;
    const auto climb = [&](int& body) {
      if (model.bodies[body].joint != none) loops_[k].push_back(model.bodies[body].joint);
      body = model.bodies[body].inboard;
    };
    for (int a = model.joints[j].parent, b = model.joints[j].child; a != b;)
      climb(b == none || (a != none && depth[a] >= depth[b]) ? a : b);
  }
}

const std::vector<Components>& UndeterminedReactions::find(MachineSystem& system, bool redundant) {
  std::fill(marks_.begin(), marks_.end(), 0u);
  const std::vector<LinkMotion>& links = system.links();
  for (const Closure& c : model_.closures)
    for (const Equation& e : c.idle) add_idle(c, e, links);
  if (!redundant) return marks_;
  system.factorise({.mass = 1, .damping = 0, .stiffness = 0}, zero_, nullptr);
  Elimination& elimination = system.elimination();
  for (std::size_t d = 0; d < elimination.dependent().size(); ++d) {
    elimination.null_vector(d, lambda_);
    add_null_vector(links);
  }
  return marks_;
}

// All joints of the loop, and only those, transmit the wrench of the equation, which acts across the loop's
// plane.
void UndeterminedReactions::add_idle(const Closure& closure, const Equation& idle,
                                     const std::vector<LinkMotion>& links) {
  const auto k = static_cast<std::size_t>(&closure - model_.closures.data());
  const Vector6d wrench = evaluate(closure, idle, links).c_b;
  const auto add = [&](int joint) {
    const Vector6d reaction = about_joint(joint, wrench, links);
    mark(joint, reaction, reaction.cwiseAbs().maxCoeff());
  };
  add(joint_of_[k]);
  for (const int joint : loops_[k]) add(joint);
}

// Wrenches that the joints transmit when the multipliers are lambda_.
void UndeterminedReactions::add_null_vector(const std::vector<LinkMotion>& links) {
  for (Vector6d& w : carried_) w.setZero();
  for (std::size_t j = 0; j < model_.joints.size(); ++j) {
    const SceneJoint& joint = model_.joints[j];
    passed_[j].setZero();
    if (joint.closure == none) continue;
    const Closure& c = model_.closures[joint.closure];
    for (int k = 0; k < c.size(); ++k)
      act(joint, evaluate(c, c.equations[k], links), lambda_[c.first + k], passed_[j]);
  }
  for (auto b = model_.outward.rbegin(); b != model_.outward.rend(); ++b)
    if (model_.bodies[*b].inboard != none) carried_[model_.bodies[*b].inboard] += carried_[*b];

  double largest = 0;
  for (int j = 0; j < std::ssize(model_.joints); ++j) {
    const SceneJoint& joint = model_.joints[j];
    Vector6d& F = passed_[j];
    if (joint.closure == none && joint.type != scene::JointType::free)
      F = joint.reversed ? Vector6d(-carried_[joint.parent]) : carried_[joint.child];
    F = about_joint(j, F, links);
    largest = std::max(largest, F.cwiseAbs().maxCoeff());
  }
  if (largest == 0) return;
  for (int j = 0; j < std::ssize(model_.joints); ++j) mark(j, passed_[j], largest);
}

void UndeterminedReactions::act(const SceneJoint& joint, const EquationValue& e, double lambda,
                                Vector6d& passed) {
  passed -= lambda * e.c_b;
  if (joint.child != none) carried_[joint.child] += lambda * e.c_b;
  if (joint.parent != none) carried_[joint.parent] -= lambda * e.c_a;
}

// Torque about the joint, divided by the size of the machine, and force.
Vector6d UndeterminedReactions::about_joint(int joint, const Vector6d& wrench,
                                            const std::vector<LinkMotion>& links) const {
  const SceneJoint& j = model_.joints[joint];
  const Vector3d p = links[j.link].point(j.p_LJ), f = wrench.tail<3>();
  return spatial((wrench.head<3>() - p.cross(f)) / model_.size, f);
}

void UndeterminedReactions::mark(int joint, const Vector6d& reaction, double largest) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(reaction[3 + k]) > smallest * largest) marks_[joint] |= 1u << k;
    if (std::abs(reaction[k]) > smallest * largest) marks_[joint] |= 1u << (3 + k);
  }
}

std::vector<const char*> component_names(Components components) {
  static constexpr const char* names[] = {"force.x",  "force.y",  "force.z",
                                          "torque.x", "torque.y", "torque.z"};
  std::vector<const char*> list;
  for (int k = 0; k < 6; ++k)
    if (components & (1u << k)) list.push_back(names[k]);
  return list;
}

}  // namespace tandem::mbd
