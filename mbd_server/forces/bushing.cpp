#include "mbd_server/forces/bushing.hpp"

#include <numbers>

#include "common/error.hpp"

namespace tandem::mbd {

BushingForce evaluate(const BushingOnLinks& bushing, const std::vector<LinkMotion>& links) {
  const LinkMotion &a = links[bushing.a.link], &b = links[bushing.b.link];
  BushingForce f;
  f.p = b.point(bushing.b.p_LP);
  const Matrix3d R = a.R_WL.transpose();
  const Vector3d turn = to_eigen(rotation_vector(to_quat(a.q_WL.conjugate() * b.q_WL)));
  if (turn.norm() > 0.99 * std::numbers::pi)
    throw Error(ErrorCode::numerics, "bushing \"" + bushing.name + "\" is turned by half a turn",
                "mbd_server", "a bushing is for small rotations: use a joint");
  Vector6d displacement, rate;
  displacement << R * (f.p - a.point(bushing.a.p_LP)), turn;
  rate << R * at_point(b.V - a.V, f.p), R * (b.V - a.V).head<3>();
  const Vector6d local = -(bushing.stiffness * displacement + bushing.damping * rate);
  f.on_b << a.R_WL * local.head<3>(), a.R_WL * local.tail<3>();
  f.energy = 0.5 * displacement.dot(bushing.stiffness * displacement);

  // Transforms to the axes of a; a rotation w of b relative to a changes the rotation vector by T^-T w.
  Matrix6d in_a = Matrix6d::Zero(), moved = Matrix6d::Zero(), out = Matrix6d::Zero();
  in_a.topRightCorner<3, 3>() = in_a.bottomLeftCorner<3, 3>() = R;
  moved.topRightCorner<3, 3>() = R;
  moved.bottomLeftCorner<3, 3>() = tangent_operator(turn).transpose().inverse() * R;
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = a.R_WL;
  f.d_displacement = -out * bushing.stiffness * moved;
  f.d_velocity = -out * bushing.damping * in_a;
  return f;
}

}  // namespace tandem::mbd
