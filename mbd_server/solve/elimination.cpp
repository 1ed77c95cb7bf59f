#include "mbd_server/solve/elimination.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace tandem::mbd {
namespace {

constexpr double round_off = 4 * std::numeric_limits<double>::epsilon();
// A row of G that depends on others at a singular position leaves a pivot of at most this share of the sum of
// its terms' sizes.
constexpr double dependence = 1e-11;
// An entry of G of at most this share of the largest possible value is taken as zero; so is one of a few
// units in the last place of the positions.
constexpr double zero_entry = 1e-9, zero_position = 1e-15;
// A row whose terms are less than this share of their largest possible values may consist of rounded data
// only: as a pivot it comes last.
constexpr double rounded_row = 1e-6;
// Least pivot of a chosen row relative to its terms: a sine of 0.1 to the rows before.
constexpr double good_pivot = 1e-2;

}  // namespace

Elimination::Elimination(const Model& model)
    : model_(model),
      blocks_(model),
      free_(model, blocks_),
      plan_(model, blocks_.connections),
      branch_of_(model.links.size(), none),
      joint_blocks_(static_cast<std::size_t>(plan_.joint_blocks)),
      values_(static_cast<std::size_t>(plan_.values)),
      pivot_(blocks_.connections.size()),
      null_(pivot_),
      level_(pivot_.size()),
      nominal_(pivot_.size()),
      reach_(joint_blocks_.size()),
      redundant_(model.closures.size(), 0),
      is_redundant_(static_cast<std::size_t>(model.equations), false),
      excluded_(is_redundant_),
      force_(model.links.size()),
      right_(pivot_.size()),
      z_(pivot_.size()),
      y_(model.links.size(), Eigen::Matrix<double, 18, 1>::Zero()),
      local_(model.links.size()),
      locked_(static_cast<std::size_t>(model.freedoms), false),
      unused_(VectorXd::Zero(model.freedoms)) {
  int size = 0;
  for (const Link& link : model.links) {
    joint_place_.push_back(size);
    size += link.freedoms() == 3 ? JointView<3>::size : (link.freedoms() == 1 ? JointView<1>::size : 0);
  }
  joint_values_.resize(static_cast<std::size_t>(size));
  for (LinkIndex i = 1; i < std::ssize(model.links); ++i) {
    const LinkIndex parent = model.links[i].parent;
    if (parent == 0 || parent == i - 1 || branch_of_[parent] != none) continue;
    branch_of_[parent] = static_cast<int>(branches_.size());
    branches_.emplace_back(Matrix6x18d::Zero());
  }
  dependent_.reserve(static_cast<std::size_t>(model.equations));
  left_out_.reserve(static_cast<std::size_t>(model.equations));
  measure_reach();
}

// Reach of rotating joints: a force with a lever of the loop's length. Reach of sliding joints: a force along
// the joint. Couplers act on two coordinates only.
void Elimination::measure_reach() {
  noise_.clear();
  std::vector<double> length(model_.links.size(), 0);  // of the loops that a link is in [m]
  for (LinkIndex i = 1; i < std::ssize(plan_.links); ++i) {
    const Link& link = model_.links[i];
    for (const auto& active : plan_.links[i].active) {
      if (blocks_.connections[active.connection].soft) continue;
      const Closure& c = model_.closures[active.connection];
      Reach& reach = reach_[active.joint_block];
      if (c.is_coupler()) {
        for (const CoupledLink& term : c.terms)
          if (i == term.link) reach.torque = term.factor * term.factor;
        if (c.terms.empty()) reach.torque = (i == c.a ? c.ratio * c.ratio : 0) + (i == c.b ? 1 : 0);
        continue;
      }
      length[i] = std::max(length[i], c.reach);
      const bool turns = rotates(link.kind);
      reach.force =
          turns ? c.reach * c.reach + (link.kind == Elementary::screw ? link.pitch * link.pitch : 0) : 1;
      reach.torque = turns ? 1 : 0;
    }
  }
  metric_ = VectorXd::Ones(model_.freedoms);
  for (LinkIndex i = 1; i < std::ssize(model_.links); ++i) {
    const Link& link = model_.links[i];
    if (link.freedoms() == 0 || rotates(link.kind)) continue;
    const double L = length[i] > 0 ? length[i] : model_.size;
    metric_.segment(link.u, link.freedoms()).setConstant(1 / (L * L));
  }
  for (const Closure& c : model_.closures)
    noise_.push_back(zero_entry + (c.is_coupler() ? 0 : zero_position * model_.size / c.reach));
}

void Elimination::connect(const std::vector<std::pair<LinkIndex, LinkIndex>>& links) {
  if (links == in_contact_) return;
  in_contact_ = links;
  free_.connect(links);
  blocks_.set_contacts(links, free_.active());
  plan_ = EliminationPlan(model_, blocks_.connections);
  const std::size_t count = blocks_.connections.size();
  joint_blocks_.resize(static_cast<std::size_t>(plan_.joint_blocks));
  values_.resize(static_cast<std::size_t>(plan_.values));
  pivot_.resize(count), null_.resize(count), level_.resize(count), nominal_.resize(count);
  right_.resize(count), z_.resize(count);
  reach_.assign(joint_blocks_.size(), {});
  measure_reach();
}

void Elimination::set_redundant(const std::vector<int>& equations) {
  std::fill(redundant_.begin(), redundant_.end(), 0);
  std::fill(is_redundant_.begin(), is_redundant_.end(), false);
  for (const int e : equations) is_redundant_[static_cast<std::size_t>(e)] = true;
  for (std::size_t k = 0; k < redundant_.size(); ++k)
    for (int j = 0; j < model_.closures[k].size(); ++j)
      if (is_redundant_[static_cast<std::size_t>(model_.closures[k].first + j)]) ++redundant_[k];
}

void Elimination::reserve_null_space(std::size_t equations) {
  null_space_.setZero(model_.equations, static_cast<Eigen::Index>(equations));
}

Eigen::Index Elimination::factorise(const Dynamics& dynamics, const MatrixWeights& weights, const VectorXd& x,
                                    const std::vector<int>* locked) {
  rule_ = {.of_terms = dependence, .of_nominal = 0, .counted = true};
  if (locked)
    for (const int u : *locked) locked_[static_cast<std::size_t>(u)] = true;
  const Eigen::Index singular = sweep(dynamics, weights, x);
  if (locked) std::fill(locked_.begin(), locked_.end(), false);
  return singular;
}

void Elimination::factorise_geometry(const Dynamics& dynamics, double independent,
                                     const std::vector<bool>& left_out) {
  rule_ = {.of_terms = 0, .of_nominal = independent * independent, .counted = false};
  geometric_ = true;
  excluded_ = left_out;
  sweep(dynamics, {.mass = 0, .damping = 0, .stiffness = 0}, unused_.setZero());
  geometric_ = false;
  std::fill(excluded_.begin(), excluded_.end(), false);
}

// The massless, force-free link, with the unit metric for its joint.
void Elimination::make_link_geometric(LinkIndex i) {
  const int n = model_.links[i].freedoms();
  own_.K.setZero(), own_.turn.setZero(), own_.Y.setZero();
  own_.Y.topLeftCorner(6, n) = own_.S.leftCols(n);
  own_.diag.head(n) = metric_.segment(n > 0 ? model_.links[i].u : 0, n);
}

Eigen::Index Elimination::sweep(const Dynamics& dynamics, const MatrixWeights& weights, const VectorXd& x) {
  connect(dynamics.links_in_contact());
  dynamics.linearise(weights, blocks_);
  std::fill(values_.begin(), values_.end(), 0.0);
  for (Matrix6x18d& K : branches_) K.setZero();
  dependent_.clear(), left_out_.clear();
  smallest_share_ = 1, tightest_ = none;
  for (std::size_t k = 0; k < blocks_.connections.size(); ++k) {
    const Connection& c = blocks_.connections[k];
    level_[k].setZero(), nominal_[k] = {};
    if (!c.soft) continue;
    block(plan_.connections[k].diagonal, c.size, c.size).diagonal().setConstant(-1);
    if (!geometric_) continue;
    ConnectionBlocks& b = blocks_.blocks[k];
    b.C_a.setZero(), b.C_b.setZero(), b.R_a.setZero(), b.R_b.setZero();
    b.on_q_a = b.on_q_b = {};
    for (ConnectionSide& side : b.more) side = {};
  }
  const LinkIndex end = static_cast<LinkIndex>(plan_.links.size());
  for (LinkIndex i = end - 1; i > 0; --i) {
    if (free_.has(i)) continue;
    dynamics.linearise_link(i, weights, x, own_);
    if (geometric_) make_link_geometric(i);
    if (blocks_.grounded_of[i] != none && !geometric_) own_.K += blocks_.grounded[blocks_.grounded_of[i]];
    if (i + 1 < end && model_.links[i + 1].parent == i) own_.K += next_;
    if (branch_of_[i] != none) own_.K += branches_[branch_of_[i]];
    for (const auto& [k, from, into] : plan_.links[i].merges) {
      ConnectionBlocks& b = blocks_.blocks[k];
      b.C(into) += b.C(from), b.R(into) += b.R(from);
      b.C(from).setZero(), b.R(from).setZero();
    }
    for (const int k : plan_.links[i].own) eliminate_connection(k, i);
    const int n = model_.links[i].freedoms();
    bool regular = true;
    if (n == 1)
      regular = eliminate_joint<1>(i);
    else if (n == 3)
      regular = eliminate_joint<3>(i);
    else
      pass_to_parent(i, own_.K);
    if (!regular) return model_.links[i].u;
  }
  for (const int k : plan_.links[0].own) eliminate_connection(k, 0);
  return factorise_free_bodies(dynamics, weights, x);
}

Eigen::Index Elimination::factorise_free_bodies(const Dynamics& dynamics, const MatrixWeights& weights,
                                                const VectorXd& x) {
  LinkBlocks shift;
  for (std::size_t i = 0; i < free_.bodies().size(); ++i) {
    const FreeBodies::Body& body = free_.bodies()[i];
    if (!free_.has(body.rotation)) continue;
    if (geometric_) {
      free_.set_diagonal(i, metric_.segment<6>(body.u));
      continue;
    }
    dynamics.linearise_link(body.translation, weights, x, shift);
    dynamics.linearise_link(body.rotation, weights, x, own_);
    if (blocks_.grounded_of[body.rotation] != none)
      own_.K += blocks_.grounded[blocks_.grounded_of[body.rotation]];
    free_.set_body(i, shift, own_, own_.K);
  }
  const bool coupled = !geometric_ && (weights.stiffness != 0 || weights.damping != 0);
  return free_.factorise(coupled ? &blocks_.free_pairs : nullptr);
}

void Elimination::add_travel(const VectorXd& x, std::vector<Eigen::Vector2d>& travel) const {
  for (LinkIndex i = 1; i < std::ssize(plan_.links); ++i) {
    const Link& link = model_.links[i];
    if (link.freedoms() == 0) continue;
    const double moved = x.segment(link.u, link.freedoms()).norm();
    for (const auto& active : plan_.links[i].active) {
      if (blocks_.connections[active.connection].soft) continue;
      const Reach& reach = reach_[active.joint_block];
      travel[active.connection] += moved * Eigen::Vector2d(std::sqrt(reach.force), std::sqrt(reach.torque));
    }
  }
}

// In a chain the parent is visited next, so that its input stays in registers and cache.
void Elimination::pass_to_parent(LinkIndex i, const Matrix6x18d& K) {
  const LinkIndex parent = model_.links[i].parent;
  if (parent == 0) return;
  if (parent == i - 1)
    next_ = K;
  else
    branches_[branch_of_[parent]] += K;
}

// D x + S^T K y_p + sum (column z) = r,  D = S^T K Y + diag: x is eliminated from all terms of the parent.
template <int n>
bool Elimination::eliminate_joint(LinkIndex i) {
  using Square = Eigen::Matrix<double, n, n>;
  const Link& link = model_.links[i];
  const LinkBlocks& own = own_;
  const auto& active = plan_.links[i].active;
  JointView<n> left = joint<n>(i);
  left.S = own.S.leftCols<n>();
  left.Y = own.Y.leftCols<n>();
  const auto S = own.S.leftCols<n>();
  const auto Y = own.Y.leftCols<n>();

  // Here and below: Eigen's product for large matrices takes longer than these small ones.
  const Eigen::Matrix<double, 6, n> KY = own.K.lazyProduct(Y);
  Square D = S.transpose() * KY;
  double level = own.diag.head<n>().cwiseAbs().maxCoeff();
  for (int m = 0; m < n; ++m) {
    D(m, m) += own.diag[m];
    level = std::max(level, S.col(m).cwiseProduct(KY.col(m)).template lpNorm<1>());
  }
  Square inverse = Square::Zero();  // zero for a locked joint
  if (!locked_[static_cast<std::size_t>(link.u)]) {
    if constexpr (n == 1) {
      if (!(std::abs(D(0, 0)) > round_off * level)) return false;
    } else {
      if (!(std::abs(D.determinant()) > round_off * D.cwiseAbs().colwise().maxCoeff().prod())) return false;
    }
    inverse = D.inverse();
  }
  left.inverse = inverse;
  if (link.parent == 0 && active.empty()) return true;

  Eigen::Matrix<double, n, 18> SK;
  Eigen::Matrix<double, 6, n> U_inverse;
  if (link.parent > 0) {
    const Eigen::Matrix<double, 6, n> U = KY + own.turn.leftCols<n>();
    SK.noalias() = S.transpose().lazyProduct(own.K);
    U_inverse.noalias() = U.lazyProduct(inverse);
    left.to_parent = U;
    left.from_parent = SK.transpose();
    own_.K.noalias() -= U_inverse.lazyProduct(SK);
    pass_to_parent(i, own_.K);
  }
  for (const auto& a : active) {
    const Connection& c = blocks_.connections[a.connection];
    ConnectionBlocks& b = blocks_.blocks[a.connection];
    if (a.merges) b.C_a += b.C_b, b.R_a += b.R_b, b.C_b.setZero(), b.R_b.setZero();
    Matrix6d& C = b.C(a.side);
    Matrix6x18d& R = b.R(a.side);
    JointBlock& block = joint_blocks_[a.joint_block];
    auto column = block.column.template topRows<n>();
    auto row = block.row.template leftCols<n>();
    if (a.acts) column.noalias() = S.transpose().lazyProduct(C);
    if (a.depends) row.noalias() = R.lazyProduct(Y);
    if (c.direct) {
      const auto add = [&](const OnCoordinate& on_q) { column(0, 0) += on_q.column, row(0, 0) += on_q.row; };
      if (i == c.a)
        add(b.on_q_a);
      else if (i == c.b)
        add(b.on_q_b);
      for (std::size_t s = 0; s < c.more.size(); ++s)
        if (i == c.more[s]) add(b.more[s].on_q);
    }
    // Columns of C and rows of R beyond the size of the connection are zero.
    if (link.parent == 0) continue;
    if (a.acts) C.noalias() -= U_inverse.lazyProduct(column);
    if (!a.depends) continue;
    const Eigen::Matrix<double, 6, n> row_inverse = row.lazyProduct(inverse);
    R.noalias() -= row_inverse.lazyProduct(SK);
  }
  const int* place = plan_.links[i].blocks.data();
  for (std::size_t k = 0; k < active.size(); ++k) {
    if (!active[k].depends) continue;
    const int size_k = blocks_.connections[active[k].connection].size;
    const Eigen::Matrix<double, Eigen::Dynamic, n, 0, 6, n> row =
        joint_blocks_[active[k].joint_block].row.template leftCols<n>().topRows(size_k) * inverse;
    for (std::size_t l = 0; l < active.size(); ++l) {
      if (!active[l].acts) continue;
      const int size_l = blocks_.connections[active[l].connection].size;
      const auto column = joint_blocks_[active[l].joint_block].column.template topRows<n>().leftCols(size_l);
      block(*place++, size_k, size_l).noalias() -= row.lazyProduct(column);
      if (k == l)
        for (int j = 0; j < size_k; ++j)
          level_[active[k].connection][j] += std::abs(row.row(j).dot(column.col(j)));
    }
    const double mobility = inverse.diagonal().cwiseAbs().maxCoeff();
    nominal_[active[k].connection].force += mobility * reach_[active[k].joint_block].force;
    nominal_[active[k].connection].torque += mobility * reach_[active[k].joint_block].torque;
  }
  return true;
}

// Exchanges up to `most` unknowns and right-hand sides of a block, those with the largest pivots first
// (Gauss-Jordan). Chosen rows need good pivots. Returns whether there were `most`.
bool Elimination::exchange(int k, Matrix6d& T, Swept& swept, int most, Rows rows) {
  const Connection& c = blocks_.connections[k];
  const int m = c.size;
  bool allowed[6] = {};
  double least[6] = {}, scale[6] = {}, nominal[6] = {};  // a pivot exceeds the least one
  for (int j = 0; j < m && !c.soft; ++j) {
    const auto e = static_cast<std::size_t>(c.first + j);
    allowed[j] = !(excluded_[e] || (rows == Rows::chosen && is_redundant_[e]));
    nominal[j] = nominal_[k].of(is_torque(model_.closures[k].equations[j].kind));
    least[j] = std::max(std::max(rule_.of_nominal, noise_[k] * noise_[k]) * nominal[j],
                        rule_.of_terms * level_[k][j]);
    scale[j] = std::max(level_[k][j], rounded_row * nominal[j]);
  }
  for (int in = 0; in < most; ++in) {
    int p = -1;
    double best = rows == Rows::chosen ? good_pivot : 0, share = 1;
    for (int j = 0; j < m; ++j) {
      if (swept[j]) continue;
      const double size = std::abs(T(j, j));
      if (c.soft) {
        if (size > best) best = size, p = j;
        continue;
      }
      if (allowed[j] && size > least[j] && size > best * scale[j])
        best = size / scale[j], share = size / nominal[j], p = j;
    }
    if (p < 0) return false;
    if (share < smallest_share_) smallest_share_ = share, tightest_ = k;
    const double d = 1 / T(p, p);
    for (int j = 0; j < m; ++j)
      if (j != p) T(p, j) *= d;
    for (int i = 0; i < m; ++i) {
      if (i == p) continue;
      for (int j = 0; j < m; ++j)
        if (j != p) T(i, j) -= T(i, p) * T(p, j);
      T(i, p) *= -d;
    }
    T(p, p) = d;
    swept[p] = true;
  }
  return true;
}

// Inverts the own block on its independent equations.
void Elimination::invert(int k) {
  const Connection& c = blocks_.connections[k];
  const int m = c.size;
  if (c.by_neighbours) {
    // A product of two matrices with positive eigenvalues: its own diagonal may vanish.
    pivot_[k] = Matrix6d(block(plan_.connections[k].diagonal, 6, 6)).inverse();
    return;
  }
  Matrix6d T = Matrix6d::Zero();
  T.topLeftCorner(m, m) = block(plan_.connections[k].diagonal, m, m);
  Swept swept = Swept::Constant(false);
  if (c.soft) {
    exchange(k, T, swept, m, Rows::all);
  } else if (!rule_.counted || redundant_[k] == 0) {
    exchange(k, T, swept, m, Rows::all);
  } else {
    // The rows that were chosen at the start stay chosen: other rows have other errors of the data, and
    // the machine would jump by the difference. Where the chosen rows become nearly dependent, others
    // replace them.
    const Matrix6d whole = T;
    const double smallest = smallest_share_;
    const int tightest = tightest_;
    if (!exchange(k, T, swept, m - redundant_[k], Rows::chosen)) {
      T = whole, swept.setConstant(false);
      smallest_share_ = smallest, tightest_ = tightest;
      exchange(k, T, swept, m - redundant_[k], Rows::all);
    }
  }
  pivot_[k].setZero();
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j)
      if (swept[i] && swept[j]) pivot_[k](i, j) = T(i, j);
  for (int d = 0; d < m; ++d) {
    if (swept[d]) continue;
    dependent_.push_back(c.first + d);
    left_out_.push_back({k, d});
    null_[k].col(d).setZero();
    null_[k](d, d) = 1;
    for (int i = 0; i < m; ++i)
      if (swept[i]) null_[k](i, d) = -T(i, d);
  }
}

void Elimination::eliminate_connection(int k, LinkIndex at) {
  invert(k);
  const int m = blocks_.connections[k].size;
  ConnectionBlocks& own = blocks_.blocks[k];
  const auto& plan = plan_.connections[k];
  const auto pivot = pivot_[k].topLeftCorner(m, m);
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  if (at > 0) {
    own.C_a += own.C_b, own.R_a += own.R_b;
    const Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> C = own.C_a.leftCols(m) * pivot;
    own_.K.noalias() -= C * own.R_a.topRows(m);
    for (const auto& l : plan.later) {
      const int s = blocks_.connections[l.connection].size;
      ConnectionBlocks& other = blocks_.blocks[l.connection];
      const Small left = block(l.column_block, s, m).lazyProduct(pivot);
      other.C(l.side).leftCols(s).noalias() -= C.lazyProduct(block(l.row_block, m, s));
      other.R(l.side).topRows(s).noalias() -= left.lazyProduct(own.R_a.topRows(m));
    }
  }
  const std::size_t n = plan.later.size();
  for (std::size_t i = 0; i < n; ++i) {
    const int size_i = blocks_.connections[plan.later[i].connection].size;
    if (m == 6 && size_i == 6) {  // nearly all of the time of a heap, where all sizes are fixed
      using Fixed = Eigen::Map<Matrix6d>;
      const Matrix6d left = Fixed(&values_[plan.later[i].column_block]).lazyProduct(pivot_[k]);
      for (std::size_t j = 0; j < n; ++j) {
        const int size_j = blocks_.connections[plan.later[j].connection].size;
        double* to = &values_[plan.updates[i * n + j]];
        double* from = &values_[plan.later[j].row_block];
        if (size_j == 6)
          Fixed(to).noalias() -= left.lazyProduct(Fixed(from));
        else
          Block(to, 6, size_j).noalias() -= left.lazyProduct(Block(from, 6, size_j));
      }
      continue;
    }
    const Small left = block(plan.later[i].column_block, size_i, m).lazyProduct(pivot);
    for (std::size_t j = 0; j < n; ++j) {
      const int size_j = blocks_.connections[plan.later[j].connection].size;
      block(plan.updates[i * n + j], size_i, size_j).noalias() -=
          left.lazyProduct(block(plan.later[j].row_block, m, size_j));
    }
  }
}

void Elimination::solve(const VectorXd& r, const VectorXd& c, VectorXd& x, VectorXd& lambda) {
  inward(r, c);
  for (Vector6d& z : z_) z.setZero();
  outward(x);
  free_.solve(r, x);
  for (std::size_t k = 0; k < z_.size(); ++k) {
    const Connection& connection = blocks_.connections[k];
    if (!connection.soft) lambda.segment(connection.first, connection.size) = z_[k].head(connection.size);
  }
}

void Elimination::inward(const VectorXd& r, const VectorXd& c) {
  for (Vector6d& p : force_) p.setZero();
  for (std::size_t k = 0; k < right_.size(); ++k) {
    const Connection& connection = blocks_.connections[k];
    right_[k].setZero();
    if (!connection.soft) right_[k].head(connection.size) = c.segment(connection.first, connection.size);
  }
  for (LinkIndex i = static_cast<LinkIndex>(plan_.links.size()) - 1; i >= 0; --i) {
    for (const int k : plan_.links[i].own) {
      const int m = blocks_.connections[k].size;
      const Vector6d t = pivot_[k] * right_[k];
      if (i > 0) force_[i].noalias() += blocks_.blocks[k].C_a.leftCols(m) * t.head(m);
      for (const auto& l : plan_.connections[k].later) {
        const int s = blocks_.connections[l.connection].size;
        right_[l.connection].head(s).noalias() -= block(l.column_block, s, m).lazyProduct(t.head(m));
      }
    }
    if (i == 0) break;
    if (free_.has(i)) continue;
    const Link& link = model_.links[i];
    if (link.freedoms() == 1) inward_joint<1>(i, r);
    if (link.freedoms() == 3) inward_joint<3>(i, r);
    if (link.parent > 0) force_[link.parent] += force_[i];
  }
}

template <int n>
void Elimination::inward_joint(LinkIndex i, const VectorXd& r) {
  const Link& link = model_.links[i];
  const JointView<n> left = joint<n>(i);
  auto local = local_[i].head<n>();
  // Outside of the loops, where only equations have right-hand sides.
  if (r.segment<n>(link.u).isZero(0) && force_[i].isZero(0)) {
    local.setZero();
    return;
  }
  local.noalias() = left.inverse * (r.segment<n>(link.u) - left.S.transpose() * force_[i]);
  if (link.parent > 0) force_[i].noalias() += left.to_parent * local;
  for (const auto& a : plan_.links[i].active)
    if (a.depends)
      right_[a.connection].noalias() -=
          joint_blocks_[a.joint_block].row.template leftCols<n>().lazyProduct(local);
}

// On entry, z_ holds the term to be added to each connection's solution.
void Elimination::outward(VectorXd& x) {
  for (LinkIndex i = 0; i < std::ssize(plan_.links); ++i) {
    if (i > 0 && !free_.has(i)) {
      const int n = model_.links[i].freedoms();
      if (n == 1)
        outward_joint<1>(i, x);
      else if (n == 3)
        outward_joint<3>(i, x);
      else
        y_[i] = y_[model_.links[i].parent];
    }
    const auto& own = plan_.links[i].own;
    for (auto k = own.rbegin(); k != own.rend(); ++k) {
      const int m = blocks_.connections[*k].size;
      Vector6d right = right_[*k];
      if (i > 0) right.head(m).noalias() -= blocks_.blocks[*k].R_a.topRows(m).lazyProduct(y_[i]);
      for (const auto& l : plan_.connections[*k].later) {
        const int s = blocks_.connections[l.connection].size;
        right.head(m).noalias() -= block(l.row_block, m, s).lazyProduct(z_[l.connection].head(s));
      }
      z_[*k].noalias() += pivot_[*k] * right;
    }
  }
}

template <int n>
void Elimination::outward_joint(LinkIndex i, VectorXd& x) {
  const Link& link = model_.links[i];
  const JointView<n> left = joint<n>(i);
  Eigen::Matrix<double, n, 1> sum = Eigen::Matrix<double, n, 1>::Zero();
  if (link.parent > 0) sum.noalias() = left.from_parent.transpose() * y_[link.parent];
  for (const auto& a : plan_.links[i].active)
    if (a.acts)
      sum.noalias() +=
          joint_blocks_[a.joint_block].column.template topRows<n>().lazyProduct(z_[a.connection]);
  x.segment<n>(link.u) = local_[i].head<n>() - left.inverse * sum;
  y_[i].noalias() = y_[link.parent] + left.Y * x.segment<n>(link.u);
}

// The multipliers without any effect: a solution without right-hand sides in which the multiplier of the row
// is 1. The result is in z_.
void Elimination::find_null_vector(const Dependent& left_out) {
  for (Vector6d& v : right_) v.setZero();
  for (Vector6d& v : z_) v.setZero();
  for (Vector3d& v : local_) v.setZero();
  z_[left_out.connection] = null_[left_out.connection].col(left_out.row);
  outward(unused_);
}

void Elimination::null_vector(std::size_t k, VectorXd& lambda) {
  find_null_vector(left_out_[k]);
  for (std::size_t c = 0; c < model_.closures.size(); ++c)
    lambda.segment(model_.closures[c].first, model_.closures[c].size()) =
        z_[c].head(model_.closures[c].size());
}

void Elimination::shrink(VectorXd& lambda) {
  Eigen::Index found = 0;
  for (const Dependent& d : left_out_) {
    if (found == null_space_.cols()) break;
    find_null_vector(d);
    auto column = null_space_.col(found);
    for (std::size_t k = 0; k < z_.size(); ++k) {
      const Connection& c = blocks_.connections[k];
      for (int j = 0; j < c.size && !c.soft; ++j)
        column[c.first + j] = z_[k][j] / model_.force_arm[c.first + j];
    }
    for (Eigen::Index j = 0; j < found; ++j) column -= column.dot(null_space_.col(j)) * null_space_.col(j);
    const double norm = column.norm();
    if (!(norm > 0)) continue;
    column /= norm;
    double part = 0;
    for (int j = 0; j < model_.equations; ++j) part += column[j] * lambda[j] / model_.force_arm[j];
    for (int j = 0; j < model_.equations; ++j) lambda[j] -= part * column[j] * model_.force_arm[j];
    ++found;
  }
}

}  // namespace tandem::mbd
