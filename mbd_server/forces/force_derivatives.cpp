#include "mbd_server/forces/force_derivatives.hpp"

namespace tandem::mbd {

int ForceConnections::between(LinkIndex a, LinkIndex b, int size) {
  if (a != 0 && b != 0 && a != b) return add({a, b, size, true, false, none});
  for (const LinkIndex link : {a, b}) {
    if (link == 0 || to_.grounded_of[link] != none) continue;
    to_.grounded_of[link] = static_cast<int>(to_.grounded.size());
    to_.grounded.emplace_back(Matrix6x18d::Zero());
  }
  return none;
}

int ForceConnections::add(Connection connection) {
  to_.connections.push_back(std::move(connection));
  return static_cast<int>(to_.connections.size()) - 1;
}

Matrix6d cross_matrix(const Vector6d& V) {
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>() = m.bottomRightCorner<3, 3>() = skew(V.head<3>());
  m.bottomLeftCorner<3, 3>() = skew(V.tail<3>());
  return m;
}

Eigen::Matrix<double, 3, 18> ForceDerivatives::displacement(const Vector3d& p) const {
  Eigen::Matrix<double, 3, 18> form = Eigen::Matrix<double, 3, 18>::Zero();
  form.leftCols<6>() = weights.stiffness * at_point_matrix(p);
  return form;
}

Eigen::Matrix<double, 3, 18> ForceDerivatives::velocity(LinkIndex link, const Vector3d& p) const {
  Eigen::Matrix<double, 3, 18> form = Eigen::Matrix<double, 3, 18>::Zero();
  const Eigen::Matrix<double, 3, 6> L = at_point_matrix(p);
  const Vector6d& V = links[link].V;
  form.leftCols<6>() = weights.stiffness * (skew(V.head<3>()) * L - L * cross_matrix(V));
  form.middleCols<6>(6) = L;
  return form;
}

void ForceDerivatives::along_line(int connection, LinkIndex a, LinkIndex b, const SpringForce& f) {
  Form on_a = Form::Zero(), on_b = Form::Zero();
  on_a.topRows<3>() = -(f.d_distance * displacement(f.p_a) + f.d_velocity * velocity(a, f.p_a));
  on_b.topRows<3>() = f.d_distance * displacement(f.p_b) + f.d_velocity * velocity(b, f.p_b);
  place(connection, a, b, at_point_matrix(f.p_a).transpose(), at_point_matrix(f.p_b).transpose(), on_a, on_b,
        3);
}

}  // namespace tandem::mbd
