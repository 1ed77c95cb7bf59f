#include "mbd_server/io/observation.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::mbd {
namespace {

Matrix6d inertia_in_world(const BodyOnLink& body, const LinkMotion& link) {
  return spatial_inertia(body.mass, link.point(body.p_LB), link.R_WL * body.inertia * link.R_WL.transpose());
}

}  // namespace

BodyMotionState observe_body(const Model& model, const std::vector<LinkMotion>& links, int body) {
  const BodyOnLink& b = model.bodies[body];
  const LinkMotion& link = links[b.link];
  const Vector3d p = link.point(b.p_LB), v = link.velocity(p), w = link.V.head<3>();
  // at_point(A) is the acceleration of the point less w x v, and A carries -gravity.
  const Vector3d a = at_point(link.A, p) + w.cross(v) + model.gravity;
  return {{to_vec3(p), to_quat(link.q_WL * b.q_LB)},
          {to_vec3(v), to_vec3(w)},
          to_vec3(a),
          to_vec3(link.A.head<3>())};
}

const std::vector<JointObservation>& JointObserver::observe(const State& state,
                                                            const std::vector<LinkMotion>& links) {
  for (std::size_t b = 0; b < carried_.size(); ++b) {
    const BodyOnLink& body = model_.bodies[b];
    const LinkMotion& link = links[body.link];
    const Matrix6d I = inertia_in_world(body, link);
    carried_[b] = I * link.A + cross_force(link.V, I * link.V);
  }
  for (std::size_t k = 0; k < model_.boundary.size(); ++k) {
    const int b = model_.boundary[k];
    const BodyOnLink& body = model_.bodies[b];
    const auto load = state.loads.col(k);
    carried_[b] -= wrench_at(links[body.link].point(body.p_LB), load.tail<3>(), load.head<3>());
  }
  for (const Spring& spring : model_.springs) {
    const SpringForce f = evaluate(spring, links);
    if (spring.b.body != none) carried_[spring.b.body] -= wrench_at(f.p_b, f.on_b);
    if (spring.a.body != none) carried_[spring.a.body] += wrench_at(f.p_a, f.on_b);
  }
  for (auto b = model_.outward.rbegin(); b != model_.outward.rend(); ++b)
    if (model_.bodies[*b].parent != none) carried_[model_.bodies[*b].parent] += carried_[*b];

  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const SceneJoint& joint = model_.joints[j];
    JointObservation& seen = joints_[j];
    if (joint.type == scene::JointType::free) continue;
    const Vector6d& F = carried_[joint.child];
    const Vector3d p = links[joint.link].point(joint.p_LJ);
    seen.reaction = {to_vec3(F.tail<3>()), to_vec3(F.head<3>() - p.cross(F.tail<3>()))};
    if (joint.type != scene::JointType::revolute && joint.type != scene::JointType::prismatic) continue;
    seen.q = links[joint.link].coordinate.value;
    seen.rate = links[joint.link].coordinate.rate;
  }
  return joints_;
}

double energy(const Model& model, const std::vector<LinkMotion>& links) {
  double sum = 0;
  for (const BodyOnLink& body : model.bodies) {
    const LinkMotion& link = links[body.link];
    sum += 0.5 * link.V.dot(inertia_in_world(body, link) * link.V);
    sum -= body.mass * model.gravity.dot(link.point(body.p_LB));
  }
  for (const Spring& spring : model.springs) sum += evaluate(spring, links).energy;
  for (const JointForce& f : model.joint_forces) {
    const double turned = links[f.link].coordinate.value - f.rest;
    sum += 0.5 * f.stiffness * turned * turned;
  }
  return sum;
}

double constraint_violation(const std::vector<LinkMotion>& links) {
  double worst = 0;
  for (const LinkMotion& link : links) worst = std::max(worst, std::abs(link.q_WL.norm() - 1));
  return worst;
}

}  // namespace tandem::mbd
