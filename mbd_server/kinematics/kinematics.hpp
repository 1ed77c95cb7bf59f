// Recursive kinematics: poses, velocities and accelerations of all links from the joint coordinates, outward.
#pragma once

#include <vector>

#include "mbd_server/model/model.hpp"
#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

struct LinkMotion {
  Quaterniond q_WL = Quaterniond::Identity();
  Matrix3d R_WL = Matrix3d::Identity();
  Vector3d p_WL = Vector3d::Zero();  // origin [m]
  CoordinateMotion coordinate;       // of a joint with one freedom, free or prescribed
  int columns = 0;                   // of S
  Eigen::Matrix<double, 6, 3> S;     // motion subspace (6 x columns)
  Vector6d V = Vector6d::Zero();     // spatial velocity
  Vector6d A = Vector6d::Zero();  // spatial acceleration; that of the ground is -gravity, so that weight is
                                  // an inertia force without a term of its own

  Vector3d point(const Vector3d& p_LP) const { return p_WL + R_WL * p_LP; }
  Vector3d velocity(const Vector3d& p_WP) const { return at_point(V, p_WP); }
};

// V_i = V_p + S_i u_i,  A_i = A_p + S_i u'_i + V_i x S_i u_i
// (S_i is fixed in link i, so that its rate is V_i x S_i). Prescribed coordinates are evaluated at
// state.time. `links` is resized to the model's number of links at the first call only. Where `driven` is
// given, it is added to the prescribed accelerations (motions).
void compute_kinematics(const Model& model, const State& state, std::vector<LinkMotion>& links,
                        const VectorXd* driven = nullptr);

}  // namespace tandem::mbd
