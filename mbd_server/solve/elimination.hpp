// Solves [A, G^T; G, 0] [x; lambda] = [r; c] by elimination along the tree: the articulated-body algorithm
// ([Featherstone2008], chapter 7) with all derivatives, where closures and springs between links are further
// unknowns. In the inward pass each connection is eliminated at the link where its branches meet, then the
// joint; so a chain costs O(n), and a ladder of loops keeps its sparsity. The outward pass substitutes.
//
// Dependent rows of G are left out, with a multiplier of zero. The number of dependent rows of each closure
// that holds in every configuration is known from the start (redundancy.hpp); the same rows are left out as
// long as the others have good pivots. At singular positions more rows become dependent: their pivots vanish
// relative to the terms of their sums, or are round-off of zero.
#pragma once

#include <cmath>

#include "mbd_server/solve/dynamics.hpp"
#include "mbd_server/solve/elimination_plan.hpp"
#include "mbd_server/solve/free_bodies.hpp"

namespace tandem::mbd {

class Elimination {
 public:
  explicit Elimination(const Model& model);

  // Rows that depend on others in every configuration. That number of rows is left out for each closure:
  // these ones if the others have good pivots.
  void set_redundant(const std::vector<int>& equations);

  // Eliminates the iteration matrix of `dynamics`, at the state of its last residual(), which the increment
  // x has reached. Returns a coordinate whose pivot vanishes, or -1. `locked`: first freedoms of joints
  // that do not move.
  Eigen::Index factorise(const Dynamics& dynamics, const MatrixWeights& weights, const VectorXd& x,
                         const std::vector<int>* locked = nullptr);
  // The same with the unit matrix for A, in radians and relative to the loops' lengths: rank and null space
  // of G by geometry alone, independent of masses. A row takes part if its component independent of the
  // rows before it exceeds `independent` times the largest value that a row of its kind could have.
  // `left_out`: rows that never take part (equations).
  void factorise_geometry(const Dynamics& dynamics, double independent, const std::vector<bool>& left_out);
  // A r for the A of factorise_geometry().
  void weigh_geometry(VectorXd& r) const { r = r.cwiseProduct(metric_); }
  void solve(const VectorXd& r, const VectorXd& c, VectorXd& x, VectorXd& lambda);

  // Adds the largest possible sizes of the displacements x in the rows of each closure: of force rows [m],
  // of torque rows [rad].
  void add_travel(const VectorXd& x, std::vector<Eigen::Vector2d>& travel) const;

  // Smallest sine between a row that took part in the last factorise() and the rows before it, relative to
  // the possible value: it falls to zero towards a singular position.
  double smallest_sine() const { return std::sqrt(smallest_share_); }
  int tightest_closure() const { return tightest_; }  // closure of that row; none: there is no row

  // Equations that were left out by the last factorise() or factorise_geometry().
  const std::vector<int>& dependent() const { return dependent_; }
  // Subtracts from lambda its component in the null space of G^T, measured in forces, which leaves the
  // minimum norm. It uses at most as many dependent equations as the constructor's model can have at once,
  // see reserve_null_space().
  void shrink(VectorXd& lambda);
  void reserve_null_space(std::size_t equations);
  // The multipliers without any effect in which that of the k-th dependent() equation is 1, at the last
  // factorise().
  void null_vector(std::size_t k, VectorXd& lambda);

 private:
  using Block = Eigen::Map<Eigen::MatrixXd>;
  // Result of the elimination of a joint with n freedoms, packed closely in joint_values_: memory traffic
  // limits the speed for long chains.
  template <int n>
  struct JointView {
    Eigen::Map<Eigen::Matrix<double, 6, n>> S, to_parent;
    Eigen::Map<Eigen::Matrix<double, 18, n>> Y, from_parent;  // the latter transposed
    Eigen::Map<Eigen::Matrix<double, n, n>> inverse;

    static constexpr int size = (48 + n) * n;
    explicit JointView(double* p)
        : S(p), to_parent(p + 6 * n), Y(p + 12 * n), from_parent(p + 30 * n), inverse(p + 48 * n) {}
  };
  template <int n>
  JointView<n> joint(LinkIndex i) {
    return JointView<n>(joint_values_.data() + joint_place_[i]);
  }
  struct Dependent {
    int connection, row;
  };
  // Blocks between the joint of a link and an active connection.
  struct JointBlock {
    Eigen::Matrix<double, 3, 6> column;  // (freedoms x size)
    Eigen::Matrix<double, 6, 3> row;     // (size x freedoms)
  };

  // Decides when a row depends on those before it: its pivot is at most a share of the sum of its terms or
  // of its largest possible value, or its closure has all its independent rows already.
  struct RankRule {
    double of_terms = 0, of_nominal = 0;
    bool counted = false;
  };
  // Largest possible squares of the entries of a row in a joint's column: of a force, of a torque.
  struct Reach {
    double force = 0, torque = 0;
    double of(bool is_torque) const { return is_torque ? torque : force; }
  };
  void measure_reach();
  // Plans anew where other links than before are in contact.
  void connect(const std::vector<std::pair<LinkIndex, LinkIndex>>& links);
  Eigen::Index factorise_free_bodies(const Dynamics& dynamics, const MatrixWeights& weights,
                                     const VectorXd& x);
  Eigen::Index sweep(const Dynamics& dynamics, const MatrixWeights& weights, const VectorXd& x);
  void make_link_geometric(LinkIndex i);
  void pass_to_parent(LinkIndex i, const Matrix6x18d& K);
  template <int n>
  bool eliminate_joint(LinkIndex i);
  void eliminate_connection(int k, LinkIndex at);
  void invert(int k);
  using Swept = Eigen::Matrix<bool, 6, 1>;
  enum class Rows { chosen, all };
  bool exchange(int k, Matrix6d& T, Swept& swept, int most, Rows rows);
  void find_null_vector(const Dependent& left_out);
  void inward(const VectorXd& r, const VectorXd& c);
  template <int n>
  void inward_joint(LinkIndex i, const VectorXd& r);
  void outward(VectorXd& x);
  template <int n>
  void outward_joint(LinkIndex i, VectorXd& x);
  Block block(int place, int rows, int columns) { return {values_.data() + place, rows, columns}; }

  const Model& model_;
  Linearisation blocks_;
  std::vector<std::pair<LinkIndex, LinkIndex>> in_contact_;  // pairs of moving links, part of the plan
  FreeBodies free_;                                          // solved by themselves
  EliminationPlan plan_;
  LinkBlocks own_;              // of the link that the sweep visits
  Matrix6x18d next_;            // contribution of link i to link i - 1, where that is its parent
  std::vector<int> branch_of_;  // index in `branches_` of links with other outboard links, else none (links)
  std::vector<Matrix6x18d> branches_;  // contributions to those links
  std::vector<double> joint_values_;
  std::vector<int> joint_place_;  // offset in joint_values_ (links)
  std::vector<JointBlock> joint_blocks_;
  std::vector<double> values_;          // blocks between connections
  std::vector<Matrix6d> pivot_, null_;  // inverse of the own block, and combinations left out (connections)
  std::vector<Vector6d> level_;         // sum of the sizes of the terms of the own diagonal
  std::vector<Reach> nominal_;          // largest possible own diagonals (connections)
  std::vector<Reach> reach_;            // (joint blocks)
  std::vector<double> noise_;           // round-off of an entry, relative to its reach (closures)
  VectorXd metric_;                     // of factorise_geometry() (freedoms)
  RankRule rule_;
  double smallest_share_ = 1;                    // of the squares of rows, see smallest_sine()
  int tightest_ = none;                          // closure
  bool geometric_ = false;                       // the sweep is that of factorise_geometry()
  std::vector<int> redundant_;                   // rows (closures)
  std::vector<bool> is_redundant_, excluded_;    // (equations)
  std::vector<Vector6d> force_, right_, z_;      // p (links); right-hand sides, solutions (connections)
  std::vector<Eigen::Matrix<double, 18, 1>> y_;  // (links)
  std::vector<Vector3d> local_;                  // D^-1 (r - S^T p) (links)
  std::vector<int> dependent_;
  std::vector<Dependent> left_out_;  // with a pivot that vanished
  Eigen::MatrixXd null_space_;       // orthonormal, in forces (equations x reserved)
  std::vector<bool> locked_;         // by the first of their freedoms (freedoms)
  VectorXd unused_;
};

}  // namespace tandem::mbd
