#include "mbd_server/coupling/contact_tangents.hpp"

#include "mbd_server/io/observation.hpp"

namespace tandem::mbd {
namespace {

using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

// Displacement and rotation about the point p to the spatial displacement (rotation, displacement at the
// world's origin). Its transpose takes a wrench about the origin to (force, torque) about p.
Matrix6d about(const Vector3d& p) {
  Matrix6d T = Matrix6d::Zero();
  T.topRightCorner<3, 3>().setIdentity();
  T.bottomLeftCorner<3, 3>().setIdentity();
  T.bottomRightCorner<3, 3>() = skew(p);
  return T;
}

}  // namespace

void contact_tangents(const Model& model, const State& state, const std::vector<LinkMotion>& links,
                      std::vector<protocol::BodyTangent>& tangents) {
  tangents.clear();
  for (const int body : model.boundary) {
    const LinkIndex link = model.bodies[static_cast<std::size_t>(body)].link;
    Matrix6d by_displacement = Matrix6d::Zero(), by_velocity = Matrix6d::Zero();
    bool touches = false;
    for (const ContactPoint& point : state.contacts) {
      const LinkIndex a = model.contact.shape(point.feature.a).link,
                      b = model.contact.shape(point.feature.b).link;
      if (a != link && b != link) continue;
      const ContactForce f = evaluate(model, point, links);
      by_displacement += b == link ? f.by_b : Matrix6d(-f.by_a);
      by_velocity += f.by_velocity;
      touches = true;
    }
    if (!touches) continue;
    const Matrix6d T = about(to_eigen(observe_body(model, links, body).pose.p_WB));
    protocol::BodyTangent& tangent = tangents.emplace_back();
    tangent.body = static_cast<std::uint32_t>(body);
    Eigen::Map<RowMajor6>(tangent.stiffness.data()) = -(T.transpose() * by_displacement * T);
    Eigen::Map<RowMajor6>(tangent.damping.data()) = -(T.transpose() * by_velocity * T);
  }
}

}  // namespace tandem::mbd
