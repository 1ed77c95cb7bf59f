#include "mbd_server/forces/line_force.hpp"

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

}  // namespace tandem::mbd
