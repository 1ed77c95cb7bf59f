#include "mbd_server/solve/tree_dynamics.hpp"

namespace tandem::mbd {

TreeDynamics::TreeDynamics(const Model& model)
    : model_(model),
      links_(model.links.size()),
      loads_(model.links.size()),
      composites_(model.links.size()),
      springs_(model.springs.size()),
      P_(model.links.size()),
      dV_(model.links.size()),
      E_(model.links.size()),
      H_(model.links.size()),
      residual_(VectorXd::Zero(model.freedoms)),
      J_(Eigen::Matrix3Xd::Zero(3, model.freedoms)),
      dp_(J_),
      dv_(J_) {
  for (Load& load : loads_) load = {Matrix6d::Zero(), Matrix6d::Zero(), Vector6d::Zero()};
  support_.reserve(2 * static_cast<std::size_t>(model.freedoms));
}

const VectorXd& TreeDynamics::residual(const State& state) {
  compute_kinematics(model_, state, links_);

  for (std::size_t i = 1; i < links_.size(); ++i) {
    const Link& link = model_.links[i];
    const LinkMotion& m = links_[i];
    Load& load = loads_[i];
    load.F.setZero();
    load.D.setZero();
    if (link.mass == 0) continue;  // its inertia is zero since the constructor
    load.I = spatial_inertia(link.mass, m.point(link.com), m.R_WL * link.inertia * m.R_WL.transpose());
    load.F = load.I * m.A + cross_force(m.V, load.I * m.V);
  }
  for (std::size_t b = 0; b < model_.boundary.size(); ++b) {
    const BodyOnLink& body = model_.bodies[model_.boundary[b]];
    const auto load = state.loads.col(b);
    apply(body.link, links_[body.link].point(body.p_LB), load.tail<3>(), load.head<3>());
  }
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    const Spring& spring = model_.springs[s];
    const SpringForce& f = springs_[s] = evaluate(spring, links_);
    apply(spring.b.link, f.p_b, f.on_b, Vector3d::Zero());
    apply(spring.a.link, f.p_a, -f.on_b, Vector3d::Zero());
  }

  // Inward: B^T.
  for (std::size_t i = links_.size() - 1; i > 0; --i) {
    const Link& link = model_.links[i];
    for (int k = 0; k < link.freedoms(); ++k) residual_[link.u + k] = links_[i].S.col(k).dot(loads_[i].F);
    loads_[link.parent].F += loads_[i].F;
  }
  for (const JointForce& f : model_.joint_forces) {
    const Link& link = model_.links[f.link];
    if (link.u == none) continue;
    if (f.stiffness != 0) residual_[link.u] += f.stiffness * (state.q[link.q] - f.rest);
    residual_.segment(link.u, link.freedoms()) += f.damping * state.u.segment(link.u, link.freedoms());
  }
  return residual_;
}

// When the link moves by psi = [w; v], the load [t + p x f; f] changes by [(v + w x p) x f; 0]; less its
// turning with the link, psi x* load, that is [p x (f x w) + t x w; f x w].
void TreeDynamics::apply(LinkIndex link, const Vector3d& p, const Vector3d& force, const Vector3d& torque) {
  Load& load = loads_[link];
  load.F -= wrench_at(p, force, torque);
  load.D.topLeftCorner<3, 3>() += skew(p) * skew(force) + skew(torque);
  load.D.bottomLeftCorner<3, 3>() += skew(force);
}

}  // namespace tandem::mbd
