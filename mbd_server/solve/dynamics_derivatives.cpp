// Analytic derivatives of the residual, after [Carpentier2018]; here in world axes, for all joints whose
// subspace is fixed in their outboard link, with the weighted sum of the three matrices formed at once and
// kept as local blocks. docs/mbd_equations.md derives them.
//
// Let joint j move by x, so that all links i >= j (j and everything outboard of it) move by psi = S_j x. With
// p the parent of j,
//   dV_i = psi x V_i + V'_j x                      V'_j = V_p x S_j
//   dA_i = psi x A_i + A'_j x + (V'_j x) x V_i     A'_j = A_p x S_j + V_p x V'_j
// A rate of j moves V_i by S_j and A_i by S_j x V_i + c_j, c_j = V'_j + V_j x S_j. So with the weights,
//   eta_i = sum (damping S_j + stiffness V'_j) x_j
//   eps_i = sum (mass S_j + damping c_j + stiffness A'_j) x_j
// and the force of a link changes by I eps + G eta - stiffness D psi, in addition to its rotation with the
// link. With q = q0 o exp(x) at x != 0 a spherical joint moves by psi = S T(x): P = S T replaces S in all
// terms of stiffness.
#include <algorithm>

#include "mbd_server/forces/size_over_joint.hpp"
#include "mbd_server/solve/dynamics.hpp"

namespace tandem::mbd {

bool Dynamics::needs_velocity_gradient(const MatrixWeights& weights) const {
  return model_.gyroscopic && (weights.damping != 0 || weights.stiffness != 0);
}

void Dynamics::linearise(const MatrixWeights& weights, Linearisation& out) const {
  for (std::size_t k = 0; k < model_.closures.size(); ++k) {
    const Closure& c = model_.closures[k];
    ConnectionBlocks& block = out.blocks[k];
    for (int j = 0; j < c.size(); ++j) {
      const EquationValue& e = equations_[c.first + j];
      block.C_a.col(j) = -e.c_a;
      block.C_b.col(j) = e.c_b;
      block.on_q_a = {e.on_q_a, e.on_q_a}, block.on_q_b = {e.on_q_b, e.on_q_b};
      for (std::size_t t = 2; t < c.terms.size(); ++t) {
        ConnectionSide& side = block.more[t - 2];
        side = {};
        side.on_q = {c.terms[t].factor, c.terms[t].factor};
      }
    }
    block.R_a.leftCols<6>() = block.C_a.transpose();
    block.R_b.leftCols<6>() = block.C_b.transpose();
    block.R_a.rightCols<12>().setZero();
    block.R_b.rightCols<12>().setZero();
  }
  linearise_forces(weights, out);
}

void Dynamics::linearise_link(LinkIndex i, const MatrixWeights& weights, const VectorXd& x,
                              LinkBlocks& block) const {
  const Link& link = model_.links[i];
  const LinkMotion &m = links_[i], &p = links_[link.parent];
  if (loads_[i].applied)
    block.K.leftCols<6>() = -weights.stiffness * applied_[i];
  else
    block.K.leftCols<6>().setZero();
  if (link.mass > 0 && needs_velocity_gradient(weights))
    block.K.middleCols<6>(6) = velocity_gradient(loads_[i].I, m.V);
  else
    block.K.middleCols<6>(6).setZero();
  block.K.rightCols<6>() = loads_[i].I;

  const int n = link.freedoms();
  Matrix6x3d P = m.S;
  if (link.kind == Elementary::spherical && n > 0) P = m.S * tangent_operator(x.segment<3>(link.u));
  for (int j = 0; j < n; ++j) {
    const Vector6d S = m.S.col(j), Pj = P.col(j), dV = cross_motion(p.V, Pj);
    const Vector6d dA = cross_motion(p.A, Pj) + cross_motion(p.V, dV);
    block.S.col(j) = S;
    block.Y.col(j) << Pj, weights.damping * S + weights.stiffness * dV,
        weights.mass * S + weights.damping * cross_motion(p.V + m.V, S) + weights.stiffness * dA;
    // The total force of the link rotates with it.
    block.turn.col(j) = weights.stiffness * cross_force(Pj, loads_[i].F);
    block.diag[j] =
        weights.damping * joint_damping_[link.u + j] + weights.stiffness * joint_stiffness_[link.u + j];
    if (rotors_.size() > 0) block.diag[j] += weights.mass * rotors_[link.u + j];
  }
}

void Dynamics::linearise_forces(const MatrixWeights& weights, Linearisation& out) const {
  for (Matrix6x18d& K : out.grounded) K.setZero();
  ForceDerivatives to(weights, links_, out);
  for (const std::size_t f : matrix_order_) forces_[f]->linearise(out.of_forces[f], to);
  linearise_sizes(weights, out);
  linearise_contacts(weights, out);
  linearise_closures(weights, to, out);
}

void Dynamics::linearise_closures(const MatrixWeights& weights, ForceDerivatives& to,
                                  Linearisation& out) const {
  for (std::size_t k = 0; k < model_.closures.size(); ++k) {
    const Closure& c = model_.closures[k];
    if (!c.has_geometric_stiffness()) continue;
    GeometricStiffness turning;
    for (int j = 0; j < c.size(); ++j)
      add_geometric_stiffness(c, c.equations[j], links_, lambda_[c.first + j], turning);
    if (out.stiffness_connection[k] == none) {
      // With an end on the ground. Where the stiffness is that of torques the lower rows are zero.
      const Matrix6d by_a = weights.stiffness * turning.by_a, by_b = weights.stiffness * turning.by_b;
      if (c.b > 0) to.on(c.b).leftCols<6>() += c.a == c.b ? Matrix6d(by_a + by_b) : by_b;
      if (c.a > 0) to.on(c.a).leftCols<6>() -= c.a == c.b ? Matrix6d(by_a + by_b) : by_a;
      continue;
    }
    ForceDerivatives::Form on_a = ForceDerivatives::Form::Zero(), on_b = on_a;
    on_a.leftCols<6>() = -weights.stiffness * turning.by_a;
    on_b.leftCols<6>() = -weights.stiffness * turning.by_b;
    if (c.stiffness_is_torque()) {
      const Eigen::Matrix<double, 6, 3> torque = Matrix6d::Identity().leftCols<3>();
      to.place(out.stiffness_connection[k], c.a, c.b, torque, torque, on_a, on_b, 3);
    } else {
      to.place(out.stiffness_connection[k], c.a, c.b, Matrix6d::Identity(), Matrix6d::Identity(), on_a, on_b,
               6);
    }
  }
}

// A force of contact has no direction of its own: its whole change is in the derivatives. The change of the
// velocity of a point at rest in the world is that of V x psi besides eta: it is in by_a and by_b.
void Dynamics::linearise_contacts(const MatrixWeights& weights, Linearisation& out) const {
  for (std::size_t k = static_cast<std::size_t>(out.first_contact); k < out.blocks.size(); ++k) {
    ConnectionBlocks& block = out.blocks[k];
    const bool by_neighbours = out.connections[k].by_neighbours;
    block.C_a = (by_neighbours ? -1 : 1) * Matrix6d::Identity();
    block.C_b = by_neighbours ? Matrix6d(Matrix6d::Zero()) : Matrix6d(-Matrix6d::Identity());
    block.R_a.setZero(), block.R_b.setZero();
    for (ConnectionSide& side : block.more) side.C.setZero(), side.R.setZero();
  }
  if (weights.stiffness == 0 && weights.damping == 0) return;
  for (ContactPairBlocks& pair : out.free_pairs)
    pair.by_first.setZero(), pair.by_second.setZero(), pair.by_velocity.setZero();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto [a, b] = links_of_contact(k);
    const ContactForce f = evaluate(model_, contacts_[k], links_);
    const Matrix6d turning = weights.stiffness * rotation_of(wrench_at(f.p, f.force, f.torque));
    if (b > 0) out.grounded[out.grounded_of[b]].leftCols<6>() -= turning;
    if (a > 0) out.grounded[out.grounded_of[a]].leftCols<6>() += turning;
    if (a == 0 || b == 0) {
      Matrix6x18d& K = out.grounded[out.grounded_of[a + b]];
      K.leftCols<6>() += weights.stiffness * (a == 0 ? Matrix6d(-f.by_b) : f.by_a);
      K.middleCols<6>(6) -= f.by_velocity;
      continue;
    }
    // The connection has the change of the wrench on the second link of the two.
    const auto pair = std::lower_bound(moving_contacts_.begin(), moving_contacts_.end(),
                                       std::pair{std::min(a, b), std::max(a, b)});
    const auto& place = out.contact_places[static_cast<std::size_t>(pair - moving_contacts_.begin())];
    const double on_second = a < b ? weights.stiffness : -weights.stiffness;
    const Matrix6d by_first = on_second * (a < b ? f.by_a : f.by_b),
                   by_second = on_second * (a < b ? f.by_b : f.by_a);
    const auto add = [&](auto&& R, double sign, const Matrix6d& by, double by_velocity) {
      R.template leftCols<6>() += sign * by;
      R.template middleCols<6>(6) += sign * by_velocity * f.by_velocity;
    };
    if (place.free_pair != none) {
      ContactPairBlocks& free = out.free_pairs[static_cast<std::size_t>(place.free_pair)];
      free.by_first += by_first, free.by_second += by_second, free.by_velocity += f.by_velocity;
    }
    if (place.connection != none) {
      ConnectionBlocks& block = out.blocks[place.connection];
      add(block.R_a, 1, by_first, -1);
      add(block.R_b, 1, by_second, 1);
      continue;
    }
    // What the wrench on a link changes by its own motion is part of its K.
    add(out.grounded[out.grounded_of[std::max(a, b)]], -1, by_second, 1);
    add(out.grounded[out.grounded_of[std::min(a, b)]], 1, by_first, -1);
    if (place.free_pair != none) continue;
    add(out.blocks[place.of_b].R(place.side_of_a), 1, by_first, -1);
    add(out.blocks[place.of_a].R(place.side_of_b), -1, by_second, 1);
  }
}

// z is the change of the size, which depends on the coordinate of link a.
void Dynamics::linearise_sizes(const MatrixWeights& weights, Linearisation& out) const {
  for (std::size_t f = 0; f < model_.joint_forces.size(); ++f) {
    if (out.joint_force_connection[f] == none) continue;
    ConnectionBlocks& block = out.blocks[out.joint_force_connection[f]];
    block.C_a.setZero(), block.C_b.setZero(), block.R_a.setZero(), block.R_b.setZero();
    block.on_q_a = {0, weighted_slope(*model_.joint_forces[f].over, links_, weights)};
    block.on_q_b = {-1, 0};
  }
}

}  // namespace tandem::mbd
