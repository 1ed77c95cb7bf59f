#include "mbd_server/forces/spring_damper.hpp"

#include "common/error.hpp"

namespace tandem::mbd {

SpringForce evaluate(const Spring& spring, const std::vector<LinkMotion>& links) {
  const LinkMotion &a = links[spring.a.link], &b = links[spring.b.link];
  SpringForce f;
  f.p_a = a.point(spring.a.p_LP);
  f.p_b = b.point(spring.b.p_LP);
  const Vector3d r = f.p_b - f.p_a, r_dot = b.velocity(f.p_b) - a.velocity(f.p_a);
  const double L = r.norm();
  if (!(L > 1e-12))
    throw Error(ErrorCode::numerics,
                "the ends of spring \"" + spring.name + "\" meet, so that it has no direction", "mbd_server",
                "move its points apart, or use a prismatic joint with a spring along its axis");
  const Vector3d n = r / L;
  const double L_dot = n.dot(r_dot);
  const ForceLaw::Value elastic = spring.elastic.at(L - spring.length), viscous = spring.viscous.at(L_dot);
  const double F = elastic.force + viscous.force;
  const Matrix3d along = n * n.transpose(), across = Matrix3d::Identity() - along;
  f.on_b = -F * n;
  // d(F n) = n (k n + c dL'/dr)^T dr + F/L (1 - n n^T) dr, with dL'/dr = (1 - n n^T) r' / L.
  f.d_distance =
      -(elastic.slope * along + viscous.slope / L * n * (across * r_dot).transpose() + F / L * across);
  f.d_velocity = -viscous.slope * along;
  f.energy = spring.elastic.energy(L - spring.length);
  return f;
}

}  // namespace tandem::mbd
