#include "mbd_server/setup/topology.hpp"

#include <algorithm>
#include <numeric>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

using scene::Joint;
using scene::JointType;

// Sets of bodies that chosen joints connect.
class Groups {
 public:
  explicit Groups(std::size_t size) : of_(size) { std::iota(of_.begin(), of_.end(), 0); }
  int of(int i) {
    while (of_[i] != i) i = of_[i] = of_[of_[i]];
    return i;
  }
  // Returns false where they are connected already.
  bool join(int i, int j) {
    i = of(i), j = of(j);
    if (i == j) return false;
    of_[i] = j;
    return true;
  }

 private:
  std::vector<int> of_;
};

class Finder {
 public:
  explicit Finder(const scene::Scene& scene)
      : scene_(scene),
        joints_(scene.mbd->joints),
        bodies_(static_cast<int>(scene.mbd->bodies.size())),
        at_(bodies_ + 1),
        in_tree_(joints_.size(), false) {
    for (int j = 0; j < std::ssize(joints_); ++j) {
      if (!connects(joints_[j])) continue;
      at_[parent(j)].push_back(j);
      at_[child(j)].push_back(j);
    }
  }

  Topology find() {
    const std::vector<bool> needed = find_needed();
    const std::vector<int> order = walk();  // joints by their distance from the ground
    Groups groups(static_cast<std::size_t>(bodies_) + 1);
    for (int j = 0; j < std::ssize(joints_); ++j)
      if (needed[j] || (connects(joints_[j]) && joints_[j].type == JointType::fixed))
        take(j, needed[j], groups);
    for (const int j : order) take(j, false, groups);
    for (int j = 0; j < std::ssize(joints_); ++j)
      if (connects(joints_[j])) take(j, false, groups);

    orient();
    for (int j = 0; j < std::ssize(joints_); ++j)
      if (joints_[j].type == JointType::distance || joints_[j].cut || (connects(joints_[j]) && !in_tree_[j]))
        topology_.cuts.push_back(j);
    return std::move(topology_);
  }

 private:
  // Node 0 is the ground, node b + 1 body b.
  int parent(int j) const {
    return joints_[j].parent == ground ? 0 : static_cast<int>(joints_[j].parent.value) + 1;
  }
  int child(int j) const { return static_cast<int>(joints_[j].child.value) + 1; }
  static bool connects(const Joint& joint) {
    return !joint.cut && joint.type != JointType::free && joint.type != JointType::distance;
  }

  std::vector<bool> find_needed() const {
    std::vector<bool> needed(joints_.size(), false);
    for (int j = 0; j < std::ssize(joints_); ++j) {
      const Joint& joint = joints_[j];
      needed[j] = joint.motion || joint.rate != 0 || joint.damping != 0 || joint.limits || joint.friction;
    }
    for (const scene::Coupler& coupler : scene_.mbd->couplers) {
      if (coupler.terms.empty()) needed[coupler.joint_a.value] = needed[coupler.joint_b.value] = true;
      for (const scene::CoupledJoint& term : coupler.terms) needed[term.joint.value] = true;
    }
    for (const scene::Force& force : scene_.mbd->forces) {
      if (const auto* f = std::get_if<scene::RotationalSpringDamper>(&force)) needed[f->joint.value] = true;
      if (const auto* f = std::get_if<scene::Actuator>(&force)) {
        needed[f->joint.value] = true;
        if (f->over) needed[f->over->joint.value] = true;
      }
      if (const auto* f = std::get_if<scene::BodyLoad>(&force); f && f->over)
        needed[f->over->joint.value] = true;
      if (const auto* f = std::get_if<scene::Motor>(&force)) needed[f->joint.value] = true;
      if (const auto* f = std::get_if<scene::Rope>(&force); f && f->drum) needed[f->drum->value] = true;
    }
    return needed;
  }

  void take(int j, bool needed, Groups& groups) {
    if (in_tree_[j]) return;
    in_tree_[j] = groups.join(parent(j), child(j));
    if (needed && !in_tree_[j])
      throw Error(ErrorCode::scene,
                  "joint \"" + joints_[j].name +
                      "\" closes a loop of joints that all need their coordinate: each has a motion, rate, "
                      "damping, spring, actuator, motor, drum of a rope or coupler",
                  "mbd.joints[" + std::to_string(j) + "]",
                  "leave that out at one joint of the loop, which then can be cut");
  }

  // Breadth first from the ground, then from the roots of what is not reached yet; fills roots_ at the same
  // time.
  std::vector<int> walk() {
    std::vector<bool> reached(at_.size(), false);
    std::vector<int> nodes, order;
    const auto reach = [&](int node) {
      reached[node] = true;
      nodes.push_back(node);
    };
    reach(0);
    for (std::size_t i = 0;; ++i) {
      if (i == nodes.size()) {
        const int root = next_root(reached);
        if (root == none) return order;
        roots_.push_back(root);
        reach(root);
      }
      for (const int j : at_[nodes[i]]) {
        const int other = parent(j) == nodes[i] ? child(j) : parent(j);
        if (reached[other]) continue;
        order.push_back(j);
        reach(other);
      }
    }
  }

  // A body with a free joint, else one that is the child of no joint, else any.
  int next_root(const std::vector<bool>& reached) const {
    int best = none, best_rank = 3;
    std::vector<int> rank(at_.size(), 1);
    for (int j = 0; j < std::ssize(joints_); ++j) {
      if (connects(joints_[j])) rank[child(j)] = std::max(rank[child(j)], 2);
      if (joints_[j].type == JointType::free) rank[child(j)] = 0;
    }
    for (int node = 1; node <= bodies_; ++node)
      if (!reached[node] && rank[node] < best_rank) best = node, best_rank = rank[node];
    return best;
  }

  // Directs the chosen joints outward.
  void orient() {
    topology_.edges.resize(bodies_);
    std::vector<bool> placed(at_.size(), false);
    std::vector<int> nodes{0};
    nodes.insert(nodes.end(), roots_.begin(), roots_.end());
    for (const int node : nodes) placed[node] = true;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const int node = nodes[i];
      if (node > 0) topology_.outward.push_back(node - 1);
      for (const int j : at_[node]) {
        const int other = parent(j) == node ? child(j) : parent(j);
        if (!in_tree_[j] || placed[other]) continue;
        placed[other] = true;
        topology_.edges[other - 1] = {j, node - 1, other == parent(j)};
        nodes.push_back(other);
      }
    }
  }

  const scene::Scene& scene_;
  const std::vector<Joint>& joints_;
  int bodies_;
  std::vector<std::vector<int>> at_;  // joints of each node
  std::vector<bool> in_tree_;
  std::vector<int> roots_;
  Topology topology_;
};

}  // namespace

Topology find_topology(const scene::Scene& scene) {
  return Finder(scene).find();
}

}  // namespace tandem::mbd
