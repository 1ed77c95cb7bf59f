#include "mbd_server/forces/rope.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace tandem::mbd {

double tension(const RopeOnLinks& rope, double elongation, double rate) {
  return elongation > 0 ? rope.stiffness * elongation * std::max(0.0, 1 + rope.damping * rate) : 0;
}

double dissipated_power(const RopeOnLinks& rope, double elongation, double rate) {
  if (!(elongation > 0)) return 0;
  return (tension(rope, elongation, rate) - rope.stiffness * elongation) * rate;
}

RopeStretch stretch_of(const RopeOnLinks& rope, const std::vector<LinkMotion>& links) {
  RopeStretch sum{-rope.length, 0};
  if (rope.has_drum()) {
    const CoordinateMotion& drum = links[rope.drum].coordinate;
    sum = {rope.per_angle * drum.value - rope.length, rope.per_angle * drum.rate};
  }
  for (std::size_t k = 0; k + 1 < rope.points.size(); ++k) {
    const LinkMotion &a = links[rope.points[k].link], &b = links[rope.points[k + 1].link];
    const Vector3d p_a = a.point(rope.points[k].p_LP), p_b = b.point(rope.points[k + 1].p_LP), r = p_b - p_a;
    const double L = r.norm();  // never zero, see evaluate()
    sum.elongation += L;
    sum.rate += r.dot(b.velocity(p_b) - a.velocity(p_a)) / L;
  }
  return sum;
}

void evaluate(const RopeOnLinks& rope, const std::vector<LinkMotion>& links, RopeForce& f) {
  const std::size_t spans = rope.points.size() - 1;
  f.points.resize(spans + 1), f.directions.resize(spans), f.turning.resize(spans), f.lengths.resize(spans);
  const RopeStretch stretch = stretch_of(rope, links);
  for (std::size_t k = 0; k <= spans; ++k)
    f.points[k] = links[rope.points[k].link].point(rope.points[k].p_LP);
  for (std::size_t k = 0; k < spans; ++k) {
    const LinkMotion &a = links[rope.points[k].link], &b = links[rope.points[k + 1].link];
    const Vector3d r = f.points[k + 1] - f.points[k],
                   r_dot = b.velocity(f.points[k + 1]) - a.velocity(f.points[k]);
    const double L = r.norm();
    if (!(L > 1e-12))
      throw Error(ErrorCode::numerics,
                  "points " + std::to_string(k + 1) + " and " + std::to_string(k + 2) + " of rope \"" +
                      rope.name + "\" meet, so that it has no direction between them",
                  "mbd_server", "move its points apart, or hold the bodies apart by limits of a joint");
    f.lengths[k] = L;
    f.directions[k] = r / L;
    const double L_dot = f.directions[k].dot(r_dot);
    f.turning[k] = (r_dot - L_dot * f.directions[k]) / L;
  }
  f.elongation = stretch.elongation, f.rate = stretch.rate;
  f.tension = tension(rope, f.elongation, f.rate);
  f.per_elongation = f.per_rate = 0;
  if (f.is_slack()) return;
  const double grip = 1 + rope.damping * f.rate;
  if (!(grip > 0)) return;
  f.per_elongation = rope.stiffness * grip;
  f.per_rate = rope.stiffness * f.elongation * rope.damping;
}

}  // namespace tandem::mbd
