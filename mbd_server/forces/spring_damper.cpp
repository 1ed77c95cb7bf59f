#include "mbd_server/forces/spring_damper.hpp"

#include "common/error.hpp"

namespace tandem::mbd {

Line line_between(const PointOnBody& a, const PointOnBody& b, const std::vector<LinkMotion>& links) {
  const LinkMotion &link_a = links[a.link], &link_b = links[b.link];
  Line line;
  line.p_a = link_a.point(a.p_LP);
  line.p_b = link_b.point(b.p_LP);
  const Vector3d r = line.p_b - line.p_a;
  line.r_dot = link_b.velocity(line.p_b) - link_a.velocity(line.p_a);
  line.length = r.norm();
  line.n = r / line.length;
  return line;
}

SpringForce force_along(const Line& line, const Tension& t) {
  const Vector3d& n = line.n;
  const Matrix3d along = n * n.transpose(), across = Matrix3d::Identity() - along;
  SpringForce f;
  f.p_a = line.p_a;
  f.p_b = line.p_b;
  f.on_b = -t.force * n;
  // d(F n) = n (k n + c dL'/dr)^T dr + F/L (1 - n n^T) dr, with dL'/dr = (1 - n n^T) r' / L.
  f.d_distance = -(t.by_length * along + t.by_rate / line.length * n * (across * line.r_dot).transpose() +
                   t.force / line.length * across);
  f.d_velocity = -t.by_rate * along;
  return f;
}

SpringForce evaluate(const Spring& spring, const std::vector<LinkMotion>& links) {
  const Line line = line_between(spring.a, spring.b, links);
  if (!line.has_direction())
    throw Error(ErrorCode::numerics,
                "the ends of spring \"" + spring.name + "\" meet, so that it has no direction", "mbd_server",
                "move its points apart, or use a prismatic joint with a spring along its axis");
  const ForceLaw::Value elastic = spring.elastic.at(line.length - spring.length),
                        viscous = spring.viscous.at(line.rate());
  SpringForce f = force_along(line, {elastic.force + viscous.force, elastic.slope, viscous.slope});
  f.energy = spring.elastic.energy(line.length - spring.length);
  return f;
}

}  // namespace tandem::mbd
