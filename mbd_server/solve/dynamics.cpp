#include "mbd_server/solve/dynamics.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/forces/size_over_joint.hpp"

namespace tandem::mbd {
namespace {

// Near a singular position the residual of an equation moves the machine by its inverse sine, so that
// round-off must not count as a violation there.
double above(double floor, double value) {
  return std::abs(value) > floor ? value : 0;
}

}  // namespace

Dynamics::Dynamics(const Model& model)
    : model_(model),
      links_(model.links.size()),
      loads_(model.links.size()),
      applied_(model.links.size()),
      matrix_order_(order_in_matrix(model)),
      z_(model.first_states),
      zdot_(VectorXd::Zero(z_.size())),
      equations_(static_cast<std::size_t>(model.equations)),
      residual_(VectorXd::Zero(model.freedoms)),
      joint_stiffness_(residual_),
      joint_damping_(residual_) {
  lambda_.setZero(model.equations);
  for (const auto& force : model.forces) {
    forces_.push_back(force->clone());
    if (force->rotor() == 0) continue;
    if (rotors_.size() == 0) rotors_.setZero(model.freedoms);
    rotors_[model.links[force->coordinate()].u] += force->rotor();
  }
  for (Load& load : loads_) load = {Matrix6d::Zero(), Vector6d::Zero()};
  for (VectorXd& phi : phi_) phi.setZero(model.equations);
}

void Dynamics::add_link_forces(const State& state, const VectorXd* driven) {
  compute_kinematics(model_, state, links_, driven);
  kinetic_energy_ = 0;
  for (std::size_t i = 1; i < links_.size(); ++i) add_inertia(i);
  apply_loads(state);
  apply_forces(state);
  apply_closures(state);
  apply_contacts(state);
}

const VectorXd& Dynamics::local_forces(const State& state) {
  add_link_forces(state, nullptr);
  residual_.setZero();
  add_joint_forces(state);
  return residual_;
}

const VectorXd& Dynamics::residual(const State& state, const VectorXd* driven) {
  add_link_forces(state, driven);

  // Inward: B^T.
  for (std::size_t i = links_.size() - 1; i > 0; --i) {
    const Link& link = model_.links[i];
    for (int k = 0; k < link.freedoms(); ++k) residual_[link.u + k] = links_[i].S.col(k).dot(loads_[i].F);
    if (link.parent > 0) loads_[link.parent].F += loads_[i].F;
  }
  add_joint_forces(state);
  return residual_;
}

void Dynamics::add_inertia(std::size_t i) {
  const Link& link = model_.links[i];
  const LinkMotion& m = links_[i];
  Load& load = loads_[i];
  load.F.setZero();
  load.applied = false;
  if (link.mass == 0) return;  // its inertia is zero since construction
  load.I = spatial_inertia(link.mass, m.point(link.com), m.R_WL * link.inertia * m.R_WL.transpose());
  const Vector6d momentum = load.I * m.V;
  load.F = load.I * m.A + cross_force(m.V, momentum);
  kinetic_energy_ += 0.5 * m.V.dot(momentum);
}

void Dynamics::mark_applied(LinkIndex link) {
  if (!loads_[link].applied) applied_[link].setZero();
  loads_[link].applied = true;
}

// When the link moves by psi = [w; v], the load [t + p x f; f] changes by [(v + w x p) x f; 0]; less its
// rotation with the link, psi x* load, that is [p x (f x w) + t x w; f x w].
void Dynamics::apply(LinkIndex link, const Vector3d& p, const Vector3d& force, const Vector3d& torque) {
  if (link == 0) return;
  mark_applied(link);
  loads_[link].F -= wrench_at(p, force, torque);
  applied_[link].topLeftCorner<3, 3>() += skew(p) * skew(force) + skew(torque);
  applied_[link].bottomLeftCorner<3, 3>() += skew(force);
}

// A wrench that is constant in the world.
void Dynamics::apply(LinkIndex link, const Vector6d& wrench) {
  if (link == 0) return;
  mark_applied(link);
  loads_[link].F -= wrench;
  applied_[link] += rotation_of(wrench);
}

void Dynamics::apply_loads(const State& state) {
  for (std::size_t b = 0; b < model_.boundary.size(); ++b) {
    const BodyOnLink& body = model_.bodies[model_.boundary[b]];
    const Vector6d load = state.load(static_cast<Eigen::Index>(b));
    apply(body.link, links_[body.link].point(body.p_LB), load.tail<3>(), load.head<3>());
  }
}

// Forces that rotate with their link contribute nothing to D.
class Dynamics::Receiver final : public ForceReceiver {
 public:
  explicit Receiver(Dynamics& to) : to_(to) {}
  void at_point(const PointOnBody& on, const Vector3d& p, const Vector3d& force,
                const Vector3d& torque) override {
    to_.apply(on.link, p, force, torque);
  }
  void following(const PointOnBody& on, const Vector3d& p, const Vector3d& force,
                 const Vector3d& torque) override {
    if (on.link > 0) to_.loads_[on.link].F -= wrench_at(p, force, torque);
  }
  void wrench(const PointOnBody& on, const Vector6d& wrench) override { to_.apply(on.link, wrench); }

 private:
  Dynamics& to_;
};

void Dynamics::apply_forces(const State& state) {
  Receiver receiver(*this);
  for (const auto& force : forces_) {
    force->evaluate({model_, state, links_});
    force->add_forces(receiver);
    force->write_states(z_, zdot_);
  }
}

// Forces of point equations keep their direction and act at a point of the body; all others enter the
// connection of the geometric stiffness, see add_geometric_stiffness().
void Dynamics::apply_closures(const State& state) {
  lambda_ = state.lambda;
  for (const Closure& c : model_.closures) {
    Vector6d turning = Vector6d::Zero();
    Vector3d force = Vector3d::Zero();
    bool at_points = false;
    evaluate(c, links_, equations_.data() + c.first);
    for (int k = 0; k < c.size(); ++k) {
      const int i = c.first + k;
      const EquationValue& e = equations_[i];
      phi_[0][i] = above(e.position_floor, e.position);
      phi_[1][i] = above(e.velocity_floor, e.velocity);
      phi_[2][i] = e.acceleration;
      if (c.equations[k].kind == EquationKind::point) {
        force += state.lambda[i] * c.equations[k].on_a;
        at_points = true;
      } else if (!c.is_coupler()) {
        turning += state.lambda[i] * e.c_b;
      }
    }
    if (at_points) {
      const Vector3d zero = Vector3d::Zero();
      apply(c.b, links_[c.b].point(c.p_b), -force, zero);
      apply(c.a, links_[c.a].point(c.p_a), force, zero);
    }
    if (!c.has_geometric_stiffness()) continue;
    apply(c.b, Vector6d(-turning));
    apply(c.a, turning);
  }
}

// The derivatives, which take several times longer than the forces, follow in linearise_contacts().
void Dynamics::apply_contacts(const State& state) {
  if (model_.contact.empty()) return;
  if (model_.contact.time_stepping && state.steps > 0)
    keep_contacts_of_motions(state);
  else
    contacts_ = state.contacts;
  moving_contacts_.clear();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto [a, b] = links_of_contact(k);
    if (a > 0 && b > 0) moving_contacts_.emplace_back(std::min(a, b), std::max(a, b));
    const ContactForce f = evaluate(model_, contacts_[k], links_, Derivatives::without);
    const Vector6d wrench = wrench_at(f.p, f.force, f.torque);
    if (b > 0) loads_[b].F -= wrench;
    if (a > 0) loads_[a].F += wrench;
  }
  std::sort(moving_contacts_.begin(), moving_contacts_.end());
  moving_contacts_.erase(std::unique(moving_contacts_.begin(), moving_contacts_.end()),
                         moving_contacts_.end());
}

// Time stepping has no use for the forces at the end of a step; they are part of what moves a joint.
void Dynamics::keep_contacts_of_motions(const State& state) {
  contacts_.clear();
  const auto is_moved = [&](int shape) {
    return model_.links[static_cast<std::size_t>(model_.contact.shape(shape).link)].motion != none;
  };
  for (const ContactPoint& point : state.contacts)
    if (is_moved(point.feature.a) || is_moved(point.feature.b)) contacts_.push_back(point);
}

bool Dynamics::is_fine(const VectorXd& dx) const {
  const auto displacement = [&](LinkIndex link) {
    Vector6d X = Vector6d::Zero();
    for (; link > 0; link = model_.links[link].parent)
      for (int j = 0; j < model_.links[link].freedoms(); ++j)
        X += links_[link].S.col(j) * dx[model_.links[link].u + j];
    return X;
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const double finest = contacts_[k].finest;
    if (finest == 0) continue;
    const auto [a, b] = links_of_contact(k);
    const Touch t = touch(model_, contacts_[k].feature, links_, Derivatives::without);
    const Vector6d X = displacement(b) - displacement(a);
    if (!(std::abs(t.n.dot(at_point(X, t.p))) <= finest)) return false;
  }
  return true;
}

std::pair<LinkIndex, LinkIndex> Dynamics::links_of_contact(std::size_t k) const {
  return {model_.contact.shape(contacts_[k].feature.a).link,
          model_.contact.shape(contacts_[k].feature.b).link};
}

void Dynamics::add_joint_forces(const State& state) {
  joint_stiffness_.setZero(), joint_damping_.setZero();
  for (const JointForce& f : model_.joint_forces) {
    const Link& link = model_.links[f.link];
    if (link.u == none) continue;
    for (int k = 0; k < link.freedoms(); ++k) {
      const double q = link.freedoms() == 1 ? state.q[link.q] : 0;
      const JointForceValue v = evaluate(f, model_, state, q, state.u[link.u + k]);
      residual_[link.u + k] -= v.force;
      joint_stiffness_[link.u + k] -= v.d_q;
      joint_damping_[link.u + k] -= v.d_u;
    }
  }
  for (const Closure& c : model_.closures) {
    if (!c.is_coupler()) continue;
    const EquationValue& e = equations_[c.first];
    const double lambda = state.lambda[c.first];
    for (const CoupledLink& term : c.terms)
      if (model_.links[term.link].u != none) residual_[model_.links[term.link].u] += term.factor * lambda;
    if (!c.terms.empty()) continue;
    if (c.cam && model_.links[c.a].u != none)
      joint_stiffness_[model_.links[c.a].u] += e.on_q_a_per_q_a * lambda;
    if (model_.links[c.a].u != none) residual_[model_.links[c.a].u] += e.on_q_a * lambda;
    if (model_.links[c.b].u != none) residual_[model_.links[c.b].u] += e.on_q_b * lambda;
  }
  CoordinateSums sums{residual_, joint_stiffness_, joint_damping_, kinetic_energy_};
  for (const auto& force : forces_) force->add_to_coordinates({model_, state, links_}, sums);
}

}  // namespace tandem::mbd
