#include "coordinator/schemes/body_modes.hpp"

#include <Eigen/Dense>

namespace tandem::launch {

Matrix6 mass_matrix(const scene::Body& body, const Pose& pose) {
  const Mat3d R = pose.q_WB.matrix();
  Eigen::Matrix3d turn, inertia;
  for (int i = 0; i < 3; ++i) turn.row(i) << R.row[i].x, R.row[i].y, R.row[i].z;
  const auto& I = body.inertia;  // xx yy zz xy xz yz
  inertia << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
  Matrix6 M = Matrix6::Zero();
  M.topLeftCorner<3, 3>() = body.mass * Eigen::Matrix3d::Identity();
  M.bottomRightCorner<3, 3>() = turn * inertia * turn.transpose();
  return M;
}

std::vector<BodyMode> modes_of(const std::array<double, 36>& matrix, const scene::Body& body,
                               const scene::Freedom& freedom, const Pose& pose) {
  if (freedom.fixed) return {};
  Eigen::MatrixXd J = Matrix6::Identity();
  if (freedom.single) {
    // Motion in the initial pose; a joint on the ground rotates it with the body.
    const Quat turn = pose.q_WB * body.pose.q_WB.conjugate();
    const auto& f = *freedom.single;
    const Vec3d v = turn.rotate({f[0], f[1], f[2]}), w{f[3], f[4], f[5]};
    J.resize(6, 1);
    J << v.x, v.y, v.z, w.x, w.y, w.z;
  }
  const Matrix6 A = Eigen::Map<const Matrix6>(matrix.data());
  const Eigen::MatrixXd a = J.transpose() * (0.5 * (A + A.transpose())) * J,
                        m = J.transpose() * mass_matrix(body, pose) * J;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(a, m);
  if (solver.info() != Eigen::Success) return {};
  std::vector<BodyMode> modes;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    modes.push_back({solver.eigenvalues()[i], J * solver.eigenvectors().col(i)});
  return modes;
}

}  // namespace tandem::launch
