// Analytic derivatives of the residual, after [Carpentier2018]; here in world axes, for all joints whose
// subspace is fixed in their outboard link, with the weighted sum of the three matrices formed at once and
// kept as local blocks. docs/mbd.md derives them.
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
#include "mbd_server/solve/linearisation.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "mbd_server/forces/size_over_joint.hpp"
#include "mbd_server/solve/dynamics.hpp"

namespace tandem::mbd {
namespace {

// Matrix of X -> V x X.
Matrix6d cross_matrix(const Vector6d& V) {
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = m.bottomRightCorner<3, 3>() = skew(V.head<3>());
  m.bottomLeftCorner<3, 3>() = skew(V.tail<3>());
  return m;
}

// Of each link in contact, the links that it touches, sorted.
using Neighbours = std::map<LinkIndex, std::vector<LinkIndex>>;

// The links of those groups that have more pairs than links; a group is what contacts connect.
Neighbours neighbours_in_large_groups(const std::vector<std::pair<LinkIndex, LinkIndex>>& pairs) {
  Neighbours all;
  for (const auto& [a, b] : pairs) all[a].push_back(b), all[b].push_back(a);
  std::map<LinkIndex, LinkIndex> group;   // a link of the same group that is visited first
  std::map<LinkIndex, std::size_t> ends;  // of pairs, twice their number (groups)
  std::map<LinkIndex, std::size_t> links;
  for (const auto& [first, unused] : all) {
    std::vector<LinkIndex> open{first};
    while (!open.empty()) {
      const LinkIndex link = open.back();
      open.pop_back();
      if (!group.emplace(link, first).second) continue;
      ++links[first];
      ends[first] += all.at(link).size();
      for (const LinkIndex other : all.at(link)) open.push_back(other);
    }
  }
  std::erase_if(all, [&](const auto& entry) {
    const LinkIndex of = group.at(entry.first);
    return ends.at(of) <= 2 * links.at(of);
  });
  for (auto& [link, others] : all) std::ranges::sort(others);
  return all;
}

}  // namespace

Linearisation::Linearisation(const Model& model) : grounded_of(model.links.size(), none) {
  for (const Closure& c : model.closures) {
    connections.push_back({c.a, c.b, c.size(), false, c.is_coupler(), c.first});
    for (std::size_t k = 2; k < c.terms.size(); ++k) connections.back().more.push_back(c.terms[k].link);
  }
  const auto add = [&](LinkIndex a, LinkIndex b, int size) {
    if (a != 0 && b != 0 && a != b) {
      connections.push_back({a, b, size, true, false, none});
      return static_cast<int>(connections.size()) - 1;
    }
    for (const LinkIndex link : {a, b}) {
      if (link == 0 || grounded_of[link] != none) continue;
      grounded_of[link] = static_cast<int>(grounded.size());
      grounded.emplace_back(Matrix6x18d::Zero());
    }
    return none;
  };
  for (const Spring& s : model.springs) spring_connection.push_back(add(s.a.link, s.b.link, 3));
  for (const Element& e : model.elements)
    cylinder_connection.push_back(e.is_cylinder() ? add(e.a.link, e.b.link, 3) : none);
  for (const BushingOnLinks& b : model.bushings) bushing_connection.push_back(add(b.a.link, b.b.link, 6));
  for (const Closure& c : model.closures)
    stiffness_connection.push_back(
        c.has_geometric_stiffness() ? add(c.a, c.b, c.stiffness_is_torque() ? 3 : 6) : none);
  for (const ContactShape& shape : model.contact.shapes) add(0, shape.link, 6);
  for (const TyreOnLink& tyre : model.tyres) add(0, tyre.centre.link, 6);
  for (const RopeOnLinks& rope : model.ropes) {
    std::vector<LinkIndex> moving;
    for (const PointOnBody& p : rope.points)
      if (p.link != 0 && std::find(moving.begin(), moving.end(), p.link) == moving.end())
        moving.push_back(p.link);
    const bool winds =
        rope.has_drum() && model.links[rope.drum].u != none && !rope.is_between_drum_and_ground();
    if (winds && std::find(moving.begin(), moving.end(), rope.drum) == moving.end())
      moving.push_back(rope.drum);
    std::vector<int>& spans = span_connection.emplace_back();
    for (std::size_t k = 1; k < rope.points.size(); ++k)
      spans.push_back(add(rope.points[k - 1].link, rope.points[k].link, 3));
    if (moving.size() < 2) {
      tension_connection.push_back(none);  // part of `grounded`, which the spans have made
      continue;
    }
    tension_connection.push_back(static_cast<int>(connections.size()));
    connections.push_back({moving[0], moving[1], 1, true, winds, none});
    connections.back().more.assign(moving.begin() + 2, moving.end());
  }
  const auto add_size = [&](const std::optional<SizeOverJoint>& over, LinkIndex loaded, bool on_coordinate) {
    const bool own = on_coordinate && over && over->link == loaded;
    if (!over || own || loaded == 0 || model.links[over->link].u == none) return none;
    if (on_coordinate && model.links[loaded].u == none) return none;
    connections.push_back({over->link, loaded, 1, true, true, none});
    return static_cast<int>(connections.size()) - 1;
  };
  for (const LoadOnLink& load : model.loads)
    load_connection.push_back(add_size(load.over, load.at.link, false));
  for (const JointForce& f : model.joint_forces)
    joint_force_connection.push_back(add_size(f.over, f.link, true));
  first_contact = static_cast<int>(connections.size());
  make_blocks(0);
}

void Linearisation::make_blocks(std::size_t first) {
  blocks.resize(connections.size());
  for (std::size_t k = first; k < blocks.size(); ++k) {
    blocks[k] = {Matrix6d::Zero(), Matrix6d::Zero(), Matrix6x18d::Zero(), Matrix6x18d::Zero(), {}, {}, {}};
    blocks[k].more.resize(connections[k].more.size());
  }
}

void Linearisation::set_contacts(const std::vector<std::pair<LinkIndex, LinkIndex>>& links,
                                 const std::vector<bool>& is_free) {
  connections.resize(static_cast<std::size_t>(first_contact));
  contact_places.clear();
  free_pairs.clear();
  std::vector<std::pair<LinkIndex, LinkIndex>> others;
  for (const auto& pair : links)
    if (!is_free[static_cast<std::size_t>(pair.first)]) others.push_back(pair);
  const Neighbours neighbours = neighbours_in_large_groups(others);
  std::map<LinkIndex, int> connection_of;
  for (const auto& [link, around] : neighbours) {
    connection_of[link] = static_cast<int>(connections.size());
    connections.push_back({link, around[0], 6, true, false, none, {around.begin() + 1, around.end()}, true});
  }
  const auto side = [&](LinkIndex of, LinkIndex other) {
    const auto& around = neighbours.at(of);
    return 1 + static_cast<int>(std::ranges::lower_bound(around, other) - around.begin());
  };
  for (const auto& [a, b] : links) {
    if (is_free[static_cast<std::size_t>(a)]) {
      contact_places.push_back({.free_pair = static_cast<int>(free_pairs.size())});
      free_pairs.emplace_back();
    } else if (neighbours.contains(a)) {
      contact_places.push_back(
          {none, connection_of.at(a), side(a, b), connection_of.at(b), side(b, a), none});
    } else {
      contact_places.push_back({.connection = static_cast<int>(connections.size())});
      connections.push_back({a, b, 6, true, false, none});
    }
  }
  make_blocks(static_cast<std::size_t>(first_contact));
}

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
  using Form = Eigen::Matrix<double, 6, 18>;
  // A change of force in the world acts on the link through `wrench`; the rotation with the links is in D.
  // Between two moving links the change is an unknown of its own; with an end on the ground it depends on
  // one link.
  for (Form& K : out.grounded) K.setZero();
  const auto on = [&](LinkIndex link) -> Form& { return out.grounded[out.grounded_of[link]]; };
  const auto place = [&](int connection, LinkIndex a, LinkIndex b, const auto& on_a, const auto& on_b,
                         const Form& change_a, const Form& change_b, int size) {
    if (connection != none) {
      ConnectionBlocks& block = out.blocks[connection];
      block.C_a.leftCols(size) = on_a;
      block.C_b.leftCols(size) = -on_b;
      block.R_a.topRows(size) = change_a.topRows(size);
      block.R_b.topRows(size) = change_b.topRows(size);
    } else {
      if (b > 0)
        on(b) -=
            on_b * (change_b.topRows(size) + (a == b ? Form(change_a) : Form(Form::Zero())).topRows(size));
      if (a > 0)
        on(a) +=
            on_a * (change_a.topRows(size) + (a == b ? Form(change_b) : Form(Form::Zero())).topRows(size));
    }
  };
  // Displacement of point p of a link, and change of its velocity without the rotation: d(v + w x p) =
  // at_point(psi x V + eta, p) + w x dp.
  const auto displacement = [&](const Vector3d& p) {
    Eigen::Matrix<double, 3, 18> form = Eigen::Matrix<double, 3, 18>::Zero();
    form.leftCols<6>() = weights.stiffness * at_point_matrix(p);
    return form;
  };
  const auto velocity = [&](LinkIndex link, const Vector3d& p) {
    Eigen::Matrix<double, 3, 18> form = Eigen::Matrix<double, 3, 18>::Zero();
    const Eigen::Matrix<double, 3, 6> L = at_point_matrix(p);
    const Vector6d& V = links_[link].V;
    form.leftCols<6>() = weights.stiffness * (skew(V.head<3>()) * L - L * cross_matrix(V));
    form.middleCols<6>(6) = L;
    return form;
  };
  const auto along_line = [&](int connection, LinkIndex a, LinkIndex b, const SpringForce& f) {
    Form on_a = Form::Zero(), on_b = Form::Zero();
    on_a.topRows<3>() = -(f.d_distance * displacement(f.p_a) + f.d_velocity * velocity(a, f.p_a));
    on_b.topRows<3>() = f.d_distance * displacement(f.p_b) + f.d_velocity * velocity(b, f.p_b);
    place(connection, a, b, at_point_matrix(f.p_a).transpose(), at_point_matrix(f.p_b).transpose(), on_a,
          on_b, 3);
  };
  for (std::size_t s = 0; s < springs_.size(); ++s)
    along_line(out.spring_connection[s], model_.springs[s].a.link, model_.springs[s].b.link, springs_[s]);
  for (std::size_t i = 0; i < cylinders_.size(); ++i)
    if (const Element& e = model_.elements[i]; e.is_cylinder())
      along_line(out.cylinder_connection[i], e.a.link, e.b.link, cylinders_[i]);
  for (std::size_t r = 0; r < ropes_.size(); ++r) {
    const RopeOnLinks& rope = model_.ropes[r];
    const RopeForce& f = ropes_[r];
    // The spans turn with their ends, at constant tension.
    for (std::size_t k = 0; k < f.directions.size(); ++k) {
      const Vector3d n = f.directions[k];
      const Matrix3d stiffness = -f.tension / f.lengths[k] * (Matrix3d::Identity() - n * n.transpose());
      Form on_a = Form::Zero(), on_b = Form::Zero();
      on_a.topRows<3>() = -stiffness * displacement(f.points[k]);
      on_b.topRows<3>() = stiffness * displacement(f.points[k + 1]);
      place(out.span_connection[r][k], rope.points[k].link, rope.points[k + 1].link,
            at_point_matrix(f.points[k]).transpose(), at_point_matrix(f.points[k + 1]).transpose(), on_a,
            on_b, 3);
    }
    linearise_tension(r, weights, out);
  }
  linearise_sizes(weights, out);
  for (std::size_t s = 0; s < bushings_.size(); ++s) {
    const BushingOnLinks& bushing = model_.bushings[s];
    const BushingForce& f = bushings_[s];
    const LinkIndex a = bushing.a.link, b = bushing.b.link;
    // Displacement and rotation, velocity and angular velocity of b relative to a, as an observer on a
    // measures them.
    const Eigen::Matrix<double, 3, 6> L = at_point_matrix(f.p);
    Matrix6d relative;
    relative.topRows<3>().setZero();
    relative.topLeftCorner<3, 3>().setIdentity();
    relative.bottomRows<3>() = L;
    // dv = at_point(psi x V_b + eta, p) + w_rel x dp, less the rotation with a.
    const Vector3d w = (links_[b].V - links_[a].V).head<3>();
    Matrix6d turning = -relative * cross_matrix(links_[b].V);
    turning.bottomRows<3>() += skew(w) * L;
    Form change = Form::Zero();
    change.leftCols<6>() = weights.stiffness * (f.d_displacement * relative + f.d_velocity * turning);
    change.middleCols<6>(6) = f.d_velocity * relative;
    // on_b rotates with a.
    Form turn_with_a = Form::Zero();
    turn_with_a.topLeftCorner<3, 3>() = -weights.stiffness * skew(f.on_b.head<3>());
    turn_with_a.block<3, 3>(3, 0) = -weights.stiffness * skew(f.on_b.tail<3>());
    Matrix6d wrench;  // maps force and torque at p to a spatial force
    wrench << skew(f.p), Matrix3d::Identity(), Matrix3d::Identity(), Matrix3d::Zero();
    Form change_b = wrench * change;
    change_b.topLeftCorner<3, 6>() -= weights.stiffness * skew(f.on_b.head<3>()) * L;  // p moves with b
    place(out.bushing_connection[s], a, b, Matrix6d::Identity(), Matrix6d::Identity(),
          Form(wrench * (turn_with_a - change)), change_b, 6);
  }
  for (std::size_t t = 0; t < tyres_.size(); ++t) {
    const LinkIndex wheel = model_.tyres[t].centre.link;
    if (wheel == 0) continue;
    on(wheel).leftCols<6>() -= weights.stiffness * tyres_[t].by_displacement;
    on(wheel).middleCols<6>(6) -= tyres_[t].by_velocity;
  }
  linearise_contacts(weights, out);
  for (std::size_t k = 0; k < model_.closures.size(); ++k) {
    const Closure& c = model_.closures[k];
    if (!c.has_geometric_stiffness()) continue;
    GeometricStiffness turning;
    for (int j = 0; j < c.size(); ++j)
      add_geometric_stiffness(c, c.equations[j], links_, lambda_[c.first + j], turning);
    if (out.stiffness_connection[k] == none) {
      // With an end on the ground. Where the stiffness is that of torques the lower rows are zero.
      const Matrix6d by_a = weights.stiffness * turning.by_a, by_b = weights.stiffness * turning.by_b;
      if (c.b > 0) on(c.b).leftCols<6>() += c.a == c.b ? Matrix6d(by_a + by_b) : by_b;
      if (c.a > 0) on(c.a).leftCols<6>() -= c.a == c.b ? Matrix6d(by_a + by_b) : by_a;
      continue;
    }
    Form on_a = Form::Zero(), on_b = Form::Zero();
    on_a.leftCols<6>() = -weights.stiffness * turning.by_a;
    on_b.leftCols<6>() = -weights.stiffness * turning.by_b;
    if (c.stiffness_is_torque()) {
      const Eigen::Matrix<double, 6, 3> torque = Matrix6d::Identity().leftCols<3>();
      place(out.stiffness_connection[k], c.a, c.b, torque, torque, on_a, on_b, 3);
    } else {
      place(out.stiffness_connection[k], c.a, c.b, Matrix6d::Identity(), Matrix6d::Identity(), on_a, on_b, 6);
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

// The change z of the tension acts on all links of the rope, and depends on the motion of all of them.
void Dynamics::linearise_tension(std::size_t r, const MatrixWeights& weights, Linearisation& out) const {
  const RopeOnLinks& rope = model_.ropes[r];
  const RopeForce& f = ropes_[r];
  const int connection = out.tension_connection[r];
  const auto side_of = [&](LinkIndex i) {
    const Connection& c = out.connections[connection];
    for (std::size_t s = 0; s < c.more.size(); ++s)
      if (i == c.more[s]) return static_cast<int>(s) + 2;
    return i == c.a ? 0 : 1;
  };
  if (connection != none) {
    ConnectionBlocks& block = out.blocks[connection];
    block.C_a.col(0).setZero(), block.C_b.col(0).setZero(), block.R_a.row(0).setZero(),
        block.R_b.row(0).setZero();
    for (ConnectionSide& side : block.more) side.C.col(0).setZero(), side.R.row(0).setZero();
    if (out.connections[connection].direct)
      block.on_q(side_of(rope.drum)) = {
          rope.per_angle,
          rope.per_angle * (weights.stiffness * f.per_elongation + weights.damping * f.per_rate)};
  }
  Vector6d C = Vector6d::Zero();
  Eigen::Matrix<double, 1, 18> R = Eigen::Matrix<double, 1, 18>::Zero();
  const Vector3d zero = Vector3d::Zero();
  LinkIndex moving = 0;
  for (std::size_t k = 0; k < rope.points.size(); ++k) {
    const LinkIndex i = rope.points[k].link;
    if (i == 0) continue;
    const bool first = k == 0, last = k + 1 == rope.points.size();
    // Derivatives of length and rate by the displacement of the point, and of the rate by its velocity.
    const Vector3d along = (first ? zero : f.directions[k - 1]) - (last ? zero : f.directions[k]),
                   turning = (first ? zero : f.turning[k - 1]) - (last ? zero : f.turning[k]);
    const Eigen::Matrix<double, 3, 6> L = at_point_matrix(f.points[k]);
    const Vector6d& V = links_[i].V;
    const Vector6d wrench = wrench_at(f.points[k], along);
    const Eigen::Matrix<double, 1, 3> by_place =
        (f.per_elongation * along + f.per_rate * turning).transpose() * weights.stiffness;
    const Eigen::Matrix<double, 1, 3> by_velocity = f.per_rate * along.transpose();
    Eigen::Matrix<double, 1, 18> row = Eigen::Matrix<double, 1, 18>::Zero();
    row.leftCols<6>() =
        by_place * L + weights.stiffness * by_velocity * (skew(V.head<3>()) * L - L * cross_matrix(V));
    row.middleCols<6>(6) = by_velocity * L;
    if (connection == none) {
      C += wrench, R += row, moving = i;
      continue;
    }
    const int side = side_of(i);
    ConnectionBlocks& block = out.blocks[connection];
    block.C(side).col(0) += wrench;
    block.R(side).row(0) += row;
  }
  if (connection == none && moving != 0) out.grounded[out.grounded_of[moving]] += C * R;
}

// z is the change of the size, which depends on the coordinate of link a.
void Dynamics::linearise_sizes(const MatrixWeights& weights, Linearisation& out) const {
  const auto slope = [&](const SizeOverJoint& over) {
    const double by = size_over(over, links_[over.link].coordinate).slope;
    return by * (over.of_rate ? weights.damping : weights.stiffness);
  };
  for (std::size_t l = 0; l < model_.loads.size(); ++l) {
    if (out.load_connection[l] == none) continue;
    const LoadOnLink& load = model_.loads[l];
    const LinkMotion& link = links_[load.at.link];
    const Vector3d direction = load.follows ? link.R_WL * load.direction : load.direction,
                   zero = Vector3d::Zero();
    ConnectionBlocks& block = out.blocks[out.load_connection[l]];
    block.on_q_a = {0, slope(*load.over)};
    block.on_q_b = {};
    block.C_a.setZero(), block.R_a.setZero(), block.R_b.setZero();
    block.C_b.col(0) =
        -wrench_at(link.point(load.at.p_LP), load.torque ? zero : direction, load.torque ? direction : zero);
  }
  for (std::size_t f = 0; f < model_.joint_forces.size(); ++f) {
    if (out.joint_force_connection[f] == none) continue;
    ConnectionBlocks& block = out.blocks[out.joint_force_connection[f]];
    block.C_a.setZero(), block.C_b.setZero(), block.R_a.setZero(), block.R_b.setZero();
    block.on_q_a = {0, slope(*model_.joint_forces[f].over)};
    block.on_q_b = {-1, 0};
  }
}

}  // namespace tandem::mbd
