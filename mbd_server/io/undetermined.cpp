#include "mbd_server/io/undetermined.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::mbd {
namespace {

// Components that are smaller than this share of the largest one in the machine are round-off, or come from the rounding of
// the data.
constexpr double smallest = 1e-4;

class Marker {
 public:
  Marker(const Model& model, const std::vector<LinkMotion>& links)
      : model_(model),
        links_(links),
        carried_(model.bodies.size()),
        passed_(model.joints.size()),
        marks_(model.joints.size(), 0) {}

  // What the joints pass on when the multipliers of the closures are `lambda`, and that of the idle equation is 1.
  void add(const VectorXd& lambda, const Closure* idle_of, const Equation* idle) {
    for (Vector6d& w : carried_) w.setZero();
    for (std::size_t j = 0; j < model_.joints.size(); ++j) {
      const SceneJoint& joint = model_.joints[j];
      passed_[j].setZero();
      if (joint.closure == none) continue;
      const Closure& c = model_.closures[joint.closure];
      for (int k = 0; k < c.size(); ++k) act(joint, evaluate(c, c.equations[k], links_), lambda[c.first + k], passed_[j]);
      if (&c == idle_of) act(joint, evaluate(c, *idle, links_), 1, passed_[j]);
    }
    for (auto b = model_.outward.rbegin(); b != model_.outward.rend(); ++b)
      if (model_.bodies[*b].inboard != none) carried_[model_.bodies[*b].inboard] += carried_[*b];
    mark();
  }

  std::vector<Components> marks() const { return marks_; }

 private:
  void act(const SceneJoint& joint, const EquationValue& e, double lambda, Vector6d& passed) {
    passed -= lambda * e.c_b;
    if (joint.child != none) carried_[joint.child] += lambda * e.c_b;
    if (joint.parent != none) carried_[joint.parent] -= lambda * e.c_a;
  }

  void mark() {
    double largest = 0;
    for (std::size_t j = 0; j < model_.joints.size(); ++j) {
      const SceneJoint& joint = model_.joints[j];
      Vector6d& F = passed_[j];
      if (joint.closure == none && joint.type != scene::JointType::free)
        F = joint.reversed ? Vector6d(-carried_[joint.parent]) : carried_[joint.child];
      const Vector3d p = links_[joint.link].point(joint.p_LJ);
      F.head<3>() = (F.head<3>() - p.cross(F.tail<3>())) / model_.size;
      largest = std::max(largest, F.cwiseAbs().maxCoeff());
    }
    for (std::size_t j = 0; j < passed_.size(); ++j)
      for (int k = 0; k < 3; ++k) {
        if (std::abs(passed_[j][3 + k]) > smallest * largest) marks_[j] |= 1u << k;
        if (std::abs(passed_[j][k]) > smallest * largest) marks_[j] |= 1u << (3 + k);
      }
  }

  const Model& model_;
  const std::vector<LinkMotion>& links_;
  std::vector<Vector6d> carried_;  // by the joint of each body, about the origin (bodies)
  std::vector<Vector6d> passed_;   // by each joint to its child; then torque over size, and force (joints)
  std::vector<Components> marks_;
};

}  // namespace

std::vector<Components> undetermined_components(const Model& model, const std::vector<LinkMotion>& links,
                                                const Eigen::MatrixXd& null_space) {
  Marker marker(model, links);
  for (Eigen::Index d = 0; d < null_space.cols(); ++d) marker.add(null_space.col(d), nullptr, nullptr);
  const VectorXd zero = VectorXd::Zero(model.equations);
  for (const Closure& c : model.closures)
    for (const Equation& e : c.idle) marker.add(zero, &c, &e);
  return marker.marks();
}

std::vector<const char*> component_names(Components components) {
  static constexpr const char* names[] = {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"};
  std::vector<const char*> list;
  for (int k = 0; k < 6; ++k)
    if (components & (1u << k)) list.push_back(names[k]);
  return list;
}

}  // namespace tandem::mbd
