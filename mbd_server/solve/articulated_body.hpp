// Accelerations of a tree in O(n), without an iteration matrix: the articulated-body algorithm
// ([Featherstone2008], chapter 7) with the mass matrix alone. In world axes about one origin no pass
// transforms anything between links:
//
//   inward    D_i = S_i^T I_i S_i,  U_i = I_i S_i,  r_i = S_i^T F_i + joint forces
//             I_p += I_i - U_i D_i^-1 U_i^T,  F_p += F_i - U_i D_i^-1 r_i
//   outward   a_i = -D_i^-1 (r_i + U_i^T A_p),  A_i = A_p + S_i a_i
//
// I and F are the inertias and forces that Dynamics has computed at the state's accelerations u', and a the
// change from these to the accelerations that solve the equation of motion.
#pragma once

#include <vector>

#include "mbd_server/solve/dynamics.hpp"

namespace tandem::mbd {

class ArticulatedBody {
 public:
  explicit ArticulatedBody(const Model& model);

  // After Dynamics::local_forces() at accelerations `udot`, which returned `forces`. Returns a coordinate
  // whose inertia vanishes, or -1. Does not allocate.
  Eigen::Index solve(const Dynamics& dynamics, const VectorXd& udot, const VectorXd& forces);
  // The accelerations of the last solve() (freedoms).
  const VectorXd& acceleration() const { return acceleration_; }

  // First freedoms of the spherical joints.
  const std::vector<int>& spherical() const { return spherical_; }

 private:
  // Of one link and everything outboard of it that has been eliminated.
  struct Articulated {
    Matrix6d I;
    Vector6d F;
    Matrix6x3d U;      // the first columns, as many as the joint has freedoms; likewise below
    Matrix3d inverse;  // D^-1
    Vector3d r;
  };
  template <int n>
  bool eliminate(LinkIndex i, const Dynamics& dynamics, const VectorXd& forces);
  template <int n>
  void substitute(LinkIndex i, const Dynamics& dynamics, const VectorXd& udot);

  const Model& model_;
  std::vector<Articulated> articulated_;  // (links)
  std::vector<Vector6d> change_;          // A_i (links)
  VectorXd acceleration_;                 // (freedoms)
  std::vector<int> spherical_;
};

}  // namespace tandem::mbd
