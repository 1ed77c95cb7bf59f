// Solves [A, G^T; G, 0] [x; lambda] = [r; c] by elimination along the tree: the articulated-body idea
// (Featherstone 2008, chapter 7) with all derivatives in, and with closures and springs between links as
// unknowns beside the joints. Inward over the links: each connection is eliminated at the link where its
// branches meet, then the joint; so a chain costs O(n), and a ladder of loops keeps its sparsity. Outward:
// substitution.
//
// Dependent rows of G are recognised by pivots that vanish against what they were summed from; they are left
// out, with a multiplier of zero.
#pragma once

#include "mbd_server/solve/elimination_plan.hpp"

namespace tandem::mbd {

class Elimination {
 public:
  explicit Elimination(const Model& model);

  // To be filled by Dynamics::linearise().
  Linearisation& blocks() { return blocks_; }
  // Eliminates blocks(). Returns a coordinate whose pivot vanishes, or -1. Links' blocks are used up.
  // `hold`: coordinates on which a large inertia is laid, so that they keep their value.
  Eigen::Index factorise(const std::vector<int>* hold = nullptr);
  void solve(const VectorXd& r, const VectorXd& c, VectorXd& x, VectorXd& lambda);

  // Equations that were left out by the last factorise(), and those among them that vanish altogether.
  const std::vector<int>& dependent() const { return dependent_; }
  // Subtracts from lambda what lies in the null space of G^T, measured in forces: minimum norm. Acts on as
  // many dependent equations as the constructor's model can have at once, see reserve_null_space().
  void shrink(VectorXd& lambda);
  void reserve_null_space(std::size_t equations);

 private:
  using Block = Eigen::Map<Eigen::MatrixXd>;
  // What a joint has left behind.
  struct Joint {
    Matrix3d inverse;
    Eigen::Matrix<double, 3, 18> from_parent;
    Matrix6x3d to_parent;
  };
  // Between the joint of a link and an active connection.
  struct Slot {
    Eigen::Matrix<double, 3, 6> column;  // (freedoms x size)
    Eigen::Matrix<double, 6, 3> row;     // (size x freedoms)
  };

  template <int n>
  bool eliminate_joint(LinkIndex i);
  void eliminate_connection(int k, LinkIndex at);
  void invert(int k);
  void inward(const VectorXd& r, const VectorXd& c);
  void outward(VectorXd& x);
  Block block(int place, int rows, int columns) { return {values_.data() + place, rows, columns}; }

  const Model& model_;
  Linearisation blocks_;
  EliminationPlan plan_;
  std::vector<Joint> joints_;  // (links)
  std::vector<Slot> slots_;
  std::vector<double> values_;          // blocks between connections
  std::vector<Matrix6d> pivot_, null_;  // inverse of the own block, combinations left out (connections)
  std::vector<Vector6d> level_;         // sum of the sizes of what the own diagonal was made of
  std::vector<Eigen::Matrix<bool, 6, 1>> kept_;  // equations that take part
  std::vector<Vector6d> force_, right_, z_;      // p (links); right-hand sides, solutions (connections)
  std::vector<Eigen::Matrix<double, 18, 1>> y_;  // (links)
  std::vector<Vector3d> local_;                  // D^-1 (r - S^T p) (links)
  std::vector<int> dependent_;
  struct Dependent {
    int connection, row;
  };
  std::vector<Dependent> left_out_;  // with a pivot that vanished
  Eigen::MatrixXd null_space_;       // orthonormal, in forces (equations x reserved)
  VectorXd inertia_;                 // factor on that of each coordinate: 1, or large where it is held
  VectorXd unused_;
};

}  // namespace tandem::mbd
