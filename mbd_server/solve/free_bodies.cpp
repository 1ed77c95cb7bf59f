#include "mbd_server/solve/free_bodies.hpp"

#include <Eigen/LU>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mbd_server/forces/force_element.hpp"

namespace tandem::mbd {
namespace {

constexpr double round_off_of_block = 4 * std::numeric_limits<double>::epsilon();

bool is_free(const Model& model, LinkIndex i) {
  const Link &turns = model.links[static_cast<std::size_t>(i)],
             &shifts = model.links[static_cast<std::size_t>(turns.parent)];
  return turns.kind == Elementary::spherical && turns.freedoms() == 3 && turns.mass > 0 && turns.parent > 0 &&
         shifts.kind == Elementary::translation && shifts.freedoms() == 3 && shifts.parent == 0 &&
         shifts.mass == 0 && turns.u == shifts.u + 3;
}

}  // namespace

FreeBodies::FreeBodies(const Model& model, const Linearisation& blocks)
    : model_(model), active_(model.links.size(), false) {
  if (model.contact.empty()) return;
  std::vector<bool> bound(model.links.size(), false);
  const auto bind = [&](LinkIndex link) { bound[static_cast<std::size_t>(link)] = true; };
  for (const Connection& c : blocks.connections)
    for (int side = 0; side < c.sides(); ++side) bind(c.link(side));
  for (const JointForce& f : model.joint_forces) bind(f.link);
  for (const auto& force : model.forces)
    if (force->coordinate() != none) bind(force->coordinate());
  std::vector<int> children(model.links.size(), 0);
  for (std::size_t i = 1; i < model.links.size(); ++i)
    ++children[static_cast<std::size_t>(model.links[i].parent)];
  body_of_.assign(model.links.size(), none);
  for (LinkIndex i = 1; i < std::ssize(model.links); ++i) {
    if (!is_free(model, i)) continue;
    const LinkIndex t = model.links[i].parent;
    if (bound[i] || bound[t] || children[i] != 0 || children[t] != 1) continue;
    body_of_[i] = static_cast<int>(bodies_.size());
    bodies_.push_back({t, i, model.links[t].u});
  }
  diagonal_.resize(bodies_.size());
  S_.resize(bodies_.size());
  Y_.resize(bodies_.size());
  right_.resize(bodies_.size());
  connect({});
}

void FreeBodies::connect(const std::vector<std::pair<LinkIndex, LinkIndex>>& pairs) {
  if (bodies_.empty()) return;
  // Groups of links in contact; one with any other link is not solved here.
  std::vector<LinkIndex> group(model_.links.size());
  std::iota(group.begin(), group.end(), 0);
  const auto first = [&](LinkIndex i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for (const auto& [a, b] : pairs) {
    const LinkIndex x = first(a), y = first(b);
    group[std::max(x, y)] = std::min(x, y);
  }
  std::vector<bool> mixed(model_.links.size(), false);
  for (const auto& [a, b] : pairs)
    for (const LinkIndex link : {a, b})
      if (body_of_[link] == none) mixed[first(link)] = true;
  for (const Body& body : bodies_)
    active_[body.translation] = active_[body.rotation] = !mixed[first(body.rotation)];
  touching_.clear();
  for (const auto& [a, b] : pairs)
    if (has(a)) touching_.emplace_back(body_of_[a], body_of_[b]);
  plan();
}

// Bodies that touch are ordered by approximate minimum degree.
void FreeBodies::plan() {
  std::vector<int> local(bodies_.size(), none), nodes;
  for (const auto& [a, b] : touching_)
    for (const int i : {a, b})
      if (local[i] == none) local[i] = 0, nodes.push_back(i);
  std::sort(nodes.begin(), nodes.end());
  for (std::size_t k = 0; k < nodes.size(); ++k) local[nodes[k]] = static_cast<int>(k);
  const int n = static_cast<int>(nodes.size());
  std::vector<int> order(nodes.size());  // place of each node
  std::iota(order.begin(), order.end(), 0);
  if (n > 2) {
    Eigen::SparseMatrix<double> pattern(n, n);
    std::vector<Eigen::Triplet<double>> entries;
    for (int k = 0; k < n; ++k) entries.emplace_back(k, k, 1);
    for (const auto& [a, b] : touching_)
      entries.emplace_back(local[a], local[b], 1), entries.emplace_back(local[b], local[a], 1);
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::AMDOrdering<int>()(pattern, permutation);  // the node at each place
    for (int k = 0; k < n; ++k) order[permutation.indices()[k]] = k;
  }
  place_of_.assign(bodies_.size(), none);
  at_place_.assign(nodes.size(), none);
  for (int k = 0; k < n; ++k) place_of_[nodes[k]] = order[k], at_place_[order[k]] = nodes[k];
  for (int i = 0; i < std::ssize(bodies_); ++i)
    if (place_of_[i] == none && has(bodies_[i].rotation)) {
      place_of_[i] = static_cast<int>(at_place_.size());
      at_place_.push_back(i);
    }
  // A place is coupled to the later ones that it touches, and to those of the places that come before it and
  // have it as their first.
  std::vector<std::vector<int>> later(nodes.size());
  for (const auto& [a, b] : touching_)
    later[std::min(place_of_[a], place_of_[b])].push_back(std::max(place_of_[a], place_of_[b]));
  first_.assign(1, 0);
  later_.clear();
  for (int k = 0; k < n; ++k) {
    auto& own = later[k];
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    later_.insert(later_.end(), own.begin(), own.end());
    first_.push_back(static_cast<int>(later_.size()));
    if (own.size() > 1) later[own[0]].insert(later[own[0]].end(), own.begin() + 1, own.end());
  }
  upper_.resize(later_.size());
  lower_.resize(later_.size());
  pairs_.clear();
  for (const auto& [a, b] : touching_) {
    Pair pair{place_of_[a], place_of_[b], none};
    const auto [low, high] = std::minmax(pair.a, pair.b);
    pair.upper = static_cast<int>(
        std::lower_bound(later_.begin() + first_[low], later_.begin() + first_[low + 1], high) -
        later_.begin());
    pairs_.push_back(pair);
  }
}

void FreeBodies::set_body(std::size_t i, const LinkBlocks& translation, const LinkBlocks& rotation,
                          const Matrix6x18d& K) {
  Matrix6d& S = S_[i];
  S << translation.S, rotation.S;
  Eigen::Matrix<double, 18, 6> Y;
  Y << translation.Y, rotation.Y;
  Matrix6d force = K.lazyProduct(Y);
  diagonal_[i].noalias() = S.transpose().lazyProduct(force);
  diagonal_[i].topRightCorner<3, 3>().noalias() += translation.S.transpose().lazyProduct(rotation.turn);
  diagonal_[i].diagonal().head<3>() += translation.diag;
  diagonal_[i].diagonal().tail<3>() += rotation.diag;
  Y_[i] = Y.topRows<12>();
}

void FreeBodies::set_diagonal(std::size_t i, const Eigen::Matrix<double, 6, 1>& diagonal) {
  diagonal_[i] = diagonal.asDiagonal();
}

Eigen::Index FreeBodies::factorise(const std::vector<ContactPairBlocks>* blocks) {
  coupled_ = blocks != nullptr && !pairs_.empty();
  if (coupled_) {
    for (Matrix6d& m : upper_) m.setZero();
    for (Matrix6d& m : lower_) m.setZero();
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const auto& [a, b] = touching_[k];
      const ContactPairBlocks& pair = (*blocks)[k];
      const auto rows = [&](int of, const Matrix6d& by, const Matrix6d& by_velocity, int other) {
        const Matrix6d f =
            by.lazyProduct(Y_[other].topRows<6>()) + by_velocity.lazyProduct(Y_[other].bottomRows<6>());
        return Matrix6d(S_[of].transpose().lazyProduct(f));
      };
      const Matrix6d of_b = -rows(b, pair.by_first, Matrix6d(-pair.by_velocity), a),
                     of_a = rows(a, pair.by_second, pair.by_velocity, b);
      const bool in_order = pairs_[k].a < pairs_[k].b;
      upper_[pairs_[k].upper] = in_order ? of_a : of_b;
      lower_[pairs_[k].upper] = in_order ? of_b : of_a;
    }
  }
  const int coupled_places = coupled_ ? static_cast<int>(first_.size()) - 1 : 0;
  for (int p = 0; p < std::ssize(at_place_); ++p) {
    Matrix6d& D = diagonal_[at_place_[p]];
    const double level = D.cwiseAbs().colwise().maxCoeff().prod();
    const Eigen::PartialPivLU<Matrix6d> lu(D);
    if (!(std::abs(lu.determinant()) > round_off_of_block * level)) return bodies_[at_place_[p]].u;
    D = lu.inverse();
    if (p >= coupled_places) continue;
    const int begin = first_[p], end = first_[p + 1];
    for (int e = begin; e < end; ++e) lower_[e] = Matrix6d(lower_[e].lazyProduct(D));
    for (int e = begin; e < end; ++e) {
      const int i = later_[e];
      diagonal_[at_place_[i]].noalias() -= lower_[e].lazyProduct(upper_[e]);
      int at = first_[i];
      for (int g = e + 1; g < end; ++g) {
        while (later_[at] != later_[g]) ++at;
        upper_[at].noalias() -= lower_[e].lazyProduct(upper_[g]);
        lower_[at].noalias() -= lower_[g].lazyProduct(upper_[e]);
      }
    }
  }
  return -1;
}

void FreeBodies::solve(const VectorXd& r, VectorXd& x) {
  const int places = static_cast<int>(at_place_.size()),
            coupled_places = coupled_ ? static_cast<int>(first_.size()) - 1 : 0;
  for (int p = 0; p < places; ++p) right_[p] = r.segment<6>(bodies_[at_place_[p]].u);
  for (int p = 0; p < coupled_places; ++p)
    for (int e = first_[p]; e < first_[p + 1]; ++e)
      right_[later_[e]].noalias() -= lower_[e].lazyProduct(right_[p]);
  for (int p = places; p-- > 0;) {
    if (p < coupled_places)
      for (int e = first_[p]; e < first_[p + 1]; ++e)
        right_[p].noalias() -= upper_[e].lazyProduct(right_[later_[e]]);
    right_[p] = Vector6d(diagonal_[at_place_[p]].lazyProduct(right_[p]));
    x.segment<6>(bodies_[at_place_[p]].u) = right_[p];
  }
}

}  // namespace tandem::mbd
