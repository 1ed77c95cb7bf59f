#include "mbd_server/io/observation.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/forces/element_force.hpp"
#include "mbd_server/forces/hydraulics.hpp"
#include "mbd_server/forces/joint_force.hpp"

namespace tandem::mbd {
namespace {

// Calls act(shape a, shape b, force) for every point in contact.
template <class Act>
void for_each_contact(const Model& model, const State& state, const std::vector<LinkMotion>& links,
                      const Act& act) {
  for (const ContactPoint& point : state.contacts)
    act(model.contact.shape(point.feature.a), model.contact.shape(point.feature.b),
        evaluate(model, point, links, Derivatives::without));
}

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
  return {{to_vec3(model.origin + p), to_quat(link.q_WL * b.q_LB)},
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
    const Vector6d load = state.load(static_cast<Eigen::Index>(k));
    carried_[b] -= wrench_at(links[body.link].point(body.p_LB), load.tail<3>(), load.head<3>());
  }
  apply_forces(state, links);
  for (auto b = model_.outward.rbegin(); b != model_.outward.rend(); ++b)
    if (model_.bodies[*b].inboard != none) carried_[model_.bodies[*b].inboard] += carried_[*b];

  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const SceneJoint& joint = model_.joints[j];
    JointObservation& observed = joints_[j];
    if (joint.type == scene::JointType::free) continue;
    const Vector3d p = links[joint.link].point(joint.p_LJ);
    Vector6d F = joint.closure != none ? wrench(model_.closures[joint.closure], state, links)
                 : joint.reversed      ? Vector6d(-carried_[joint.parent])
                                       : carried_[joint.child];
    observed.reaction = {to_vec3(F.tail<3>()), to_vec3(F.head<3>() - p.cross(F.tail<3>()))};
    if (joint.coordinate_link != none) {
      observed.q = links[joint.coordinate_link].coordinate.value;
      observed.rate = links[joint.coordinate_link].coordinate.rate;
    } else if (joint.closure != none) {
      observe_cut(joint, links, observed);
    }
  }
  return joints_;
}

void JointObserver::observe_cut(const SceneJoint& joint, const std::vector<LinkMotion>& links,
                                JointObservation& observed) const {
  const Closure& c = model_.closures[joint.closure];
  const LinkMotion &a = links[c.a], &b = links[c.b];
  const Vector6d V = b.V - a.V;
  const Vector3d n = a.R_WL * c.axis;
  if (joint.type == scene::JointType::prismatic) {
    observed.q = travel(c, links);
    observed.rate = n.dot(at_point(V, b.point(c.p_b)));
  } else if (joint.type == scene::JointType::revolute || joint.type == scene::JointType::screw) {
    observed.q = angle(c, links);
    observed.rate = n.dot(V.head<3>());
  }
}

// Wrench that the parent transmits to the child through a cut joint.
Vector6d JointObserver::wrench(const Closure& c, const State& state, const std::vector<LinkMotion>& links) {
  Vector6d sum = Vector6d::Zero();
  for (int k = 0; k < c.size(); ++k)
    sum -= state.lambda[c.first + k] * evaluate(c, c.equations[k], links).c_b;
  return sum;
}

void JointObserver::apply(int body, const Vector6d& wrench) {
  if (body != none) carried_[body] -= wrench;
}

class JointObserver::Receiver final : public ForceReceiver {
 public:
  explicit Receiver(JointObserver& to) : to_(to) {}
  void at_point(const PointOnBody& on, const Vector3d& p, const Vector3d& force,
                const Vector3d& torque) override {
    to_.apply(on.body, wrench_at(p, force, torque));
  }
  void following(const PointOnBody& on, const Vector3d& p, const Vector3d& force,
                 const Vector3d& torque) override {
    at_point(on, p, force, torque);
  }
  void wrench(const PointOnBody& on, const Vector6d& wrench) override { to_.apply(on.body, wrench); }

 private:
  JointObserver& to_;
};

JointObserver::JointObserver(const Model& model)
    : model_(model), carried_(model.bodies.size()), joints_(model.joints.size()) {
  for (const auto& force : model.forces) forces_.push_back(force->clone());
}

void JointObserver::apply_forces(const State& state, const std::vector<LinkMotion>& links) {
  for_each_contact(model_, state, links,
                   [&](const ContactShape& a, const ContactShape& b, const ContactForce& f) {
                     const Vector6d wrench = wrench_at(f.p, f.force, f.torque);
                     apply(b.body, wrench);
                     apply(a.body, -wrench);
                   });
  Receiver receiver(*this);
  for (const auto& force : forces_) {
    force->evaluate({model_, state, links});
    force->add_forces(receiver);
  }
  for (const SceneJoint& joint : model_.joints) {
    if (joint.closure == none) continue;
    const Closure& c = model_.closures[joint.closure];
    for (int k = 0; k < c.size(); ++k) {
      const EquationValue e = evaluate(c, c.equations[k], links);
      apply(joint.child, -state.lambda[c.first + k] * e.c_b);
      apply(joint.parent, state.lambda[c.first + k] * e.c_a);
    }
  }
}

double energy(const Model& model, const State& state, const std::vector<LinkMotion>& links) {
  double sum = potential_energy(model, state, links);
  for (const auto& force : model.forces)
    if (force->rotor() > 0) {
      const double rate = links[force->coordinate()].coordinate.rate;
      sum += 0.5 * force->rotor() * rate * rate;
    }
  for (const BodyOnLink& body : model.bodies) {
    const LinkMotion& link = links[body.link];
    sum += 0.5 * link.V.dot(inertia_in_world(body, link) * link.V);
  }
  return sum;
}

double contact_energy(const Model& model, const State& state, const std::vector<LinkMotion>& links) {
  double sum = 0;
  for_each_contact(model, state, links,
                   [&](const ContactShape&, const ContactShape&, const ContactForce& f) { sum += f.energy; });
  return sum;
}

double potential_energy(const Model& model, const State& state, const std::vector<LinkMotion>& links) {
  double sum = 0;
  for (const BodyOnLink& body : model.bodies)
    sum -= body.mass * model.gravity.dot(model.origin + links[body.link].point(body.p_LB));
  sum += contact_energy(model, state, links);
  for (const auto& force : model.forces) sum += force->stored_energy({model, state, links});
  for (const JointForce& f : model.joint_forces) sum += energy(f, links[f.link].coordinate.value);
  return sum;
}

std::vector<ElementObservation> observe_elements(const Model& model, const State& state,
                                                 const std::vector<LinkMotion>& links) {
  std::vector<ElementObservation> observed;
  for (const Element* e : forces_of<Element>(model)) {
    const ElementArgument x = argument(*e, links);
    const StatesOfElement z = states_of(*e, state.z);
    const auto* oil = e->law_as<Hydraulics>();
    const ChamberFlows flows =
        oil ? valve_flows(*oil, input_of(*e, model, state).signal.value, z) : ChamberFlows{};
    const double force = evaluate(*e, model, state, x.s, x.v).force;
    observed.push_back({e->name, oil != nullptr, x.s, x.v, force, force * x.v, oil ? z[0] : 0, oil ? z[1] : 0,
                        flows.a, flows.b});
  }
  return observed;
}

double force_scale(const Model& model, const State& state, const std::vector<LinkMotion>& links) {
  double sum = 0, torques = 0;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const BodyOnLink& body = model.bodies[b];
    const LinkMotion& link = links[body.link];
    const BodyMotionState observed = observe_body(model, links, static_cast<int>(b));
    const Matrix3d J = link.R_WL * body.inertia * link.R_WL.transpose();
    const Vector3d w = link.V.head<3>();
    sum += body.mass * (model.gravity.norm() + norm(observed.a));
    torques += (J * link.A.head<3>() + w.cross(J * w)).norm();
  }
  for (Eigen::Index k = 0; k < std::ssize(model.boundary); ++k) {
    const Vector6d load = state.load(k);
    sum += load.tail<3>().norm();
    torques += load.head<3>().norm();
  }
  for_each_contact(model, state, links, [&](const ContactShape&, const ContactShape&, const ContactForce& f) {
    sum += f.force.norm();
    torques += f.torque.norm();
  });
  for (const auto& force : model.forces) {
    const ForceSize size = force->size({model, state, links});
    sum += size.force, torques += size.torque;
  }
  for (const JointForce& f : model.joint_forces) {
    const CoordinateMotion& c = links[f.link].coordinate;
    const Elementary kind = model.links[f.link].kind;
    for (int k = 0; k < freedoms(kind); ++k) {
      const bool single = freedoms(kind) == 1;
      const double rate = single ? c.rate : state.u[model.links[f.link].u + k];
      (rotates(kind) ? torques : sum) +=
          std::abs(evaluate(f, model, state, single ? c.value : 0, rate).force);
    }
  }
  return sum + torques / model.size;
}

double constraint_violation(const Model& model, const MachineSystem& system) {
  double worst = 0;
  for (const LinkMotion& link : system.links()) worst = std::max(worst, std::abs(link.q_WL.norm() - 1));
  for (const Closure& c : model.closures)
    for (int j = 0; j < c.size(); ++j) {
      const double open = std::abs(system.equations()[static_cast<std::size_t>(c.first + j)].position);
      worst = std::max(worst, is_torque(c.equations[j].kind) ? open : open / c.reach);
    }
  return worst;
}

}  // namespace tandem::mbd
