// Free bodies that touch only each other and what does not move: their part of the iteration matrix has six
// unknowns for each body and a block for each pair in contact, A_ii x_i + sum A_ij x_j = r_i. It is
// factorised by itself, sparse, in an order that follows from the pairs alone.
//
// With the blocks of linearisation.hpp, the rows of a body are S^T f, f = K Y x + what its pairs add by the
// motion of the other body.
#pragma once

#include <utility>
#include <vector>

#include "mbd_server/solve/linearisation.hpp"

namespace tandem::mbd {

class FreeBodies {
 public:
  // A body with a translation and a rotation of its own, whose freedoms follow each other.
  struct Body {
    LinkIndex translation, rotation;
    int u;
  };

  // Only bodies of models with contacts that no joint, element or force over a coordinate connects to others.
  FreeBodies(const Model& model, const Linearisation& blocks);

  // Sets the pairs of moving links in contact, sorted. Bodies that touch other machines, however many bodies
  // are between, are left to the elimination along the tree.
  void connect(const std::vector<std::pair<LinkIndex, LinkIndex>>& pairs);
  // Whether the link is of a body that is solved here.
  bool has(LinkIndex link) const { return !body_of_.empty() && active_[static_cast<std::size_t>(link)]; }
  const std::vector<bool>& active() const { return active_; }  // (links)
  const std::vector<Body>& bodies() const { return bodies_; }

  // The blocks of a body, with those of its contacts that depend on its own motion in K.
  void set_body(std::size_t i, const LinkBlocks& translation, const LinkBlocks& rotation,
                const Matrix6x18d& K);
  void set_diagonal(std::size_t i, const Eigen::Matrix<double, 6, 1>& diagonal);
  // Factorises; `pairs`: of the blocks in contact, or none. Returns a coordinate whose pivot vanishes, or -1.
  Eigen::Index factorise(const std::vector<ContactPairBlocks>* pairs);
  void solve(const VectorXd& r, VectorXd& x);

 private:
  struct Pair {
    int a = none, b = none;  // places in the order
    int upper = none;        // entry of (min, max)
  };
  void plan();

  const Model& model_;
  std::vector<Body> bodies_;
  std::vector<int> body_of_;                   // of the rotation (links); none: it is of no free body
  std::vector<bool> active_;                   // (links)
  std::vector<std::pair<int, int>> touching_;  // bodies; of the pairs that are solved here
  // The order: place of each body, and the body at each place. Places without pairs come last.
  std::vector<int> place_of_, at_place_;
  std::vector<int> first_, later_;  // the later places that a place is coupled to (places + 1), (entries)
  std::vector<Pair> pairs_;
  bool coupled_ = false;                         // in the last factorise()
  std::vector<Matrix6d> diagonal_, S_;           // (bodies)
  std::vector<Eigen::Matrix<double, 12, 6>> Y_;  // displacement and change of velocity (bodies)
  std::vector<Matrix6d> upper_, lower_;          // (entries)
  std::vector<Vector6d> right_;                  // (places)
};

}  // namespace tandem::mbd
