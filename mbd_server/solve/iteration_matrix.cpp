// Analytic derivatives of the residual (after Carpentier & Mansard, Analytical derivatives of rigid body
// dynamics algorithms, RSS 2018; here in world axes, for all joints whose subspace is fixed in their outboard
// link, and with the three matrices summed with their weights at once). docs/mbd.md derives them.
//
// Let joint j move by x, so that all links i >= j (j and everything outboard of it) move by psi = S_j x. With
// p the parent of j,
//   dV_i = psi x V_i + V'_j x                      V'_j = V_p x S_j
//   dA_i = psi x A_i + A'_j x + (V'_j x) x V_i     A'_j = A_p x S_j + V_p x V'_j
// The first terms turn with the links and cancel in the rows of joints outboard of j. A rate of j moves V_i
// by S_j and A_i by S_j x V_i + c_j, c_j = V'_j + V_j x S_j. With the composite inertia I, velocity gradient
// G, load gradient D and force F, and m the outermost of k and j, the entry (k, j) of the weighted sum of the
// derivatives is
//   S_k^T (I_m E_j + G_m H_j - stiffness D_m P_j)  [+ stiffness S_k^T (P_j x* F_j) where k is strictly
//   inboard of j] E_j = mass S_j + damping c_j + stiffness A'_j,   H_j = damping S_j + stiffness V'_j.
// With q = q0 o exp(x) at x != 0 a spherical joint moves by psi = S T(x): P = S T stands for S in all terms
// of stiffness.
#include <algorithm>

#include "mbd_server/solve/tree_dynamics.hpp"

namespace tandem::mbd {

void TreeDynamics::matrix(const MatrixWeights& weights, const VectorXd& x, Eigen::MatrixXd& A) {
  A.setZero(model_.freedoms, model_.freedoms);
  prepare_columns(weights, x);
  prepare_composites(weights);
  add_tree(weights, A);
  add_springs(weights, A);
  add_joint_forces(weights, A);
}

void TreeDynamics::prepare_columns(const MatrixWeights& weights, const VectorXd& x) {
  for (std::size_t i = 1; i < links_.size(); ++i) {
    const Link& link = model_.links[i];
    const LinkMotion &m = links_[i], &p = links_[link.parent];
    P_[i] = m.S;
    if (link.kind == Elementary::spherical) P_[i] = m.S * tangent_operator(x.segment<3>(link.u));
    for (int j = 0; j < link.freedoms(); ++j) {
      const Vector6d S = m.S.col(j), P = P_[i].col(j), dV = cross_motion(p.V, P);
      const Vector6d dA = cross_motion(p.A, P) + cross_motion(p.V, dV);
      dV_[i].col(j) = dV;
      E_[i].col(j) = weights.mass * S + weights.damping * cross_motion(p.V + m.V, S) + weights.stiffness * dA;
      H_[i].col(j) = weights.damping * S + weights.stiffness * dV;
    }
  }
}

bool TreeDynamics::needs_velocity_gradient(const MatrixWeights& weights) const {
  return model_.gyroscopic && (weights.damping != 0 || weights.stiffness != 0);
}

void TreeDynamics::prepare_composites(const MatrixWeights& weights) {
  const bool gyroscopic = needs_velocity_gradient(weights);
  for (std::size_t i = 1; i < links_.size(); ++i) {
    composites_[i].I = loads_[i].I;
    composites_[i].D = loads_[i].D;
    if (gyroscopic) composites_[i].G = velocity_gradient(loads_[i].I, links_[i].V);
  }
  for (std::size_t i = links_.size() - 1; i > 0; --i) {
    Composite &own = composites_[i], &parent = composites_[model_.links[i].parent];
    parent.I += own.I;
    parent.D += own.D;
    if (gyroscopic) parent.G += own.G;
  }
}

void TreeDynamics::add_tree(const MatrixWeights& weights, Eigen::MatrixXd& A) {
  const double stiffness = weights.stiffness;
  const bool gyroscopic = needs_velocity_gradient(weights);
  for (std::size_t i = 1; i < links_.size(); ++i) {
    const Link& link = model_.links[i];
    const Composite& c = composites_[i];
    for (int j = 0; j < link.freedoms(); ++j) {
      const Vector6d S = links_[i].S.col(j), P = P_[i].col(j);
      // Column j: the rows of this link and of all links inboard.
      Vector6d own = c.I * E_[i].col(j) - stiffness * (c.D * P);
      if (gyroscopic) own += c.G * H_[i].col(j);
      const Vector6d inboard = own + stiffness * cross_force(P, loads_[i].F);
      // Row j: the columns of all links inboard.
      const Vector6d I_S = c.I * S, D_S = c.D.transpose() * S;
      Vector6d G_S = Vector6d::Zero();
      if (gyroscopic) G_S = c.G.transpose() * S;

      for (int k = 0; k < link.freedoms(); ++k) A(link.u + k, link.u + j) += links_[i].S.col(k).dot(own);
      for (LinkIndex n = link.parent; n > 0; n = model_.links[n].parent) {
        const Link& inner = model_.links[n];
        for (int k = 0; k < inner.freedoms(); ++k) {
          A(inner.u + k, link.u + j) += links_[n].S.col(k).dot(inboard);
          A(link.u + j, inner.u + k) +=
              I_S.dot(E_[n].col(k)) + G_S.dot(H_[n].col(k)) - stiffness * D_S.dot(P_[n].col(k));
        }
      }
    }
  }
}

// Adds what the coordinates do to point p of a link, and to its velocity: d(v + w x p) = dv + dw x p + w x dp
// with dV = psi x V + V'_j.
void TreeDynamics::add_point(LinkIndex link, const Vector3d& p, double sign) {
  const Vector6d& V = links_[link].V;
  for (LinkIndex n = link; n > 0; n = model_.links[n].parent) {
    const Link& inner = model_.links[n];
    for (int k = 0; k < inner.freedoms(); ++k) {
      const Vector6d P = P_[n].col(k);
      const Vector3d dp = at_point(P, p);
      J_.col(inner.u + k) += sign * at_point(links_[n].S.col(k), p);
      dp_.col(inner.u + k) += sign * dp;
      dv_.col(inner.u + k) +=
          sign * (at_point(cross_motion(P, V) + dV_[n].col(k), p) + V.head<3>().cross(dp));
      support_.push_back(inner.u + k);
    }
  }
}

// What turns with the links is in D; here is the rest, by which the force of a spring changes.
void TreeDynamics::add_springs(const MatrixWeights& weights, Eigen::MatrixXd& A) {
  if (weights.damping == 0 && weights.stiffness == 0) return;
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    const SpringForce& f = springs_[s];
    support_.clear();
    add_point(model_.springs[s].b.link, f.p_b, 1);
    add_point(model_.springs[s].a.link, f.p_a, -1);
    std::sort(support_.begin(), support_.end());
    support_.erase(std::unique(support_.begin(), support_.end()), support_.end());
    for (const int j : support_) {
      const Vector3d change = weights.stiffness * (f.d_distance * dp_.col(j) + f.d_velocity * dv_.col(j)) +
                              weights.damping * (f.d_velocity * J_.col(j));
      for (const int k : support_) A(k, j) -= J_.col(k).dot(change);
    }
    for (const int j : support_) J_.col(j).setZero(), dp_.col(j).setZero(), dv_.col(j).setZero();
  }
}

void TreeDynamics::add_joint_forces(const MatrixWeights& weights, Eigen::MatrixXd& A) const {
  for (const JointForce& f : model_.joint_forces) {
    const Link& link = model_.links[f.link];
    for (int k = 0; k < link.freedoms(); ++k)
      A(link.u + k, link.u + k) += weights.damping * f.damping + weights.stiffness * f.stiffness;
  }
}

}  // namespace tandem::mbd
