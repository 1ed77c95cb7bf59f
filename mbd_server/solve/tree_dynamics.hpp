// The equations of motion of the tree in joint space,
//   r(t, q, u, u') = B^T (M Y' - Q) = 0                                                       (seed eq. 5, no
//   loops)
// by one outward and one inward pass (recursive Newton-Euler), and their analytic derivatives. B, the
// velocity transformation, is never formed: its columns are the motion subspaces of the joints between a body
// and the ground, and B^T is the inward pass.
//
// Works on buffers of fixed size: no call after the first allocates.
#pragma once

#include <vector>

#include "mbd_server/forces/spring_damper.hpp"
#include "mbd_server/solve/kinematics.hpp"
#include "mbd_server/step/system.hpp"

namespace tandem::mbd {

class TreeDynamics {
 public:
  explicit TreeDynamics(const Model& model);

  // Kinematics and residual at the state, with the state's loads on the boundary bodies.
  const VectorXd& residual(const State& state);

  // A = mass dr/du' + damping dr/du + stiffness dr/dx at the state of the last residual(), with x the
  // increment in q = q0 o exp(x).
  void matrix(const MatrixWeights& weights, const VectorXd& x, Eigen::MatrixXd& A);

  const std::vector<LinkMotion>& links() const { return links_; }

 private:
  // What one link carries.
  struct Load {
    Matrix6d I;  // inertia
    Matrix6d
        D;  // change of the applied loads, less their turning with the link, per displacement of the link
    Vector6d
        F;  // inertia force less applied loads; after residual() of this link and everything outboard of it
  };
  // What a link and everything outboard of it carry.
  struct Composite {
    Matrix6d I, D;
    Matrix6d G;  // derivative of the velocity product of the inertia force with respect to V
  };

  // Force and torque of constant direction at point p of a link.
  void apply(LinkIndex link, const Vector3d& p, const Vector3d& force, const Vector3d& torque);
  bool needs_velocity_gradient(const MatrixWeights& weights) const;
  void prepare_columns(const MatrixWeights& weights, const VectorXd& x);
  void prepare_composites(const MatrixWeights& weights);
  void add_tree(const MatrixWeights& weights, Eigen::MatrixXd& A);
  void add_springs(const MatrixWeights& weights, Eigen::MatrixXd& A);
  void add_joint_forces(const MatrixWeights& weights, Eigen::MatrixXd& A) const;
  void add_point(LinkIndex link, const Vector3d& p, double sign);

  const Model& model_;
  std::vector<LinkMotion> links_;
  std::vector<Load> loads_;                                  // (links)
  std::vector<Composite> composites_;                        // (links)
  std::vector<SpringForce> springs_;                         // (springs)
  std::vector<Eigen::Matrix<double, 6, 3>> P_, dV_, E_, H_;  // iteration_matrix.cpp (links, each 6 x columns)
  VectorXd residual_;                                        // (freedoms)
  // Of one spring: the coordinates that move its ends, and what they do to p_b - p_a and its velocity.
  std::vector<int> support_;  // ascending indices of freedoms
  Eigen::Matrix3Xd J_;        // velocity per rate (3 x freedoms), zero outside the support
  Eigen::Matrix3Xd dp_, dv_;  // distance and velocity per increment, likewise
};

}  // namespace tandem::mbd
