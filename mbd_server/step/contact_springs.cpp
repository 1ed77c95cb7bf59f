#include "mbd_server/step/contact_springs.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::mbd {
namespace {

// The spring of friction gets new ends where the point of contact moves away by this share of the radius.
constexpr double rolled = 1e-9;
// That of rolling friction where the normal has turned by this angle against its directions [rad].
constexpr double turned = 1e-2;

// Stretch of a spring that slips: together with its damper it gives `force`, and never more alone.
Vector3d left_over(const Vector3d& force, const Vector3d& damping, double stiffness) {
  const Vector3d elastic = force + damping;
  return elastic.dot(force) > 0 ? Vector3d(-elastic / stiffness) : Vector3d::Zero();
}

}  // namespace

void set_rolling_spring(const Vector3d& on_a, const Vector3d& on_b, const LinkMotion& a, const LinkMotion& b,
                        RollingSpring& spring) {
  spring.on_a = a.R_WL.transpose() * on_a;
  spring.on_b = b.R_WL.transpose() * on_b;
}

void aim_springs(const Model& model, const std::vector<LinkMotion>& links, double h,
                 std::vector<ContactPoint>& points) {
  for (ContactPoint& point : points) {
    if (!(point.friction.stiffness > 0)) continue;
    const ContactFeature& feature = point.feature;
    const double radius =
        std::max(model.contact.shape(feature.a).radius, model.contact.shape(feature.b).radius);
    if (!(radius > 0)) continue;
    const LinkMotion &a = link_of(model, feature.a, links), &b = link_of(model, feature.b, links);
    const Touch t = touch(model, feature, links, Derivatives::with);
    const auto across = [&](const Vector3d& x) { return Vector3d(x - t.n.dot(x) * t.n); };
    const Vector3d rate = t.dp_a * a.V + t.dp_b * b.V - 0.5 * (at_point(a.V, t.p) + at_point(b.V, t.p)),
                   middle = t.p + 0.5 * h * across(rate);
    if (!(across(middle - a.point(point.friction.on_a)).norm() > rolled * radius)) continue;
    const Vector3d stretch = evaluate(model, point, links, Derivatives::without).spring_stretch();
    point.friction.on_a = in_link(a, middle);
    point.friction.on_b = in_link(b, middle + stretch);
  }
}

void aim_rolling_springs(const Model& model, const std::vector<LinkMotion>& links, double h,
                         std::vector<ContactPoint>& points) {
  for (ContactPoint& point : points) {
    if (!(point.rolling.stiffness > 0)) continue;
    const ContactFeature& feature = point.feature;
    const LinkMotion &a = link_of(model, feature.a, links), &b = link_of(model, feature.b, links);
    const Touch t = touch(model, feature, links, Derivatives::with);
    const Vector3d w_a = a.V.head<3>(), w_b = b.V.head<3>(), rate = t.dn_a * a.V + t.dn_b * b.V;
    const double spin_a = std::abs(t.n.dot(w_a)), spin_b = std::abs(t.n.dot(w_b));
    if (!(spin_a + spin_b > 0)) continue;
    const Vector3d moved = (spin_a * w_a + spin_b * w_b).cross(t.n) / (spin_a + spin_b),
                   middle = (t.n + 0.5 * h * (rate - moved)).normalized();
    if (!((middle - a.R_WL * point.rolling.on_a).norm() > rolled)) continue;
    const Vector3d bend = evaluate(model, point, links, Derivatives::without).bend;
    set_rolling_spring(middle, middle + bend.cross(t.n), a, b, point.rolling);
  }
}

double move_spring(const Model& model, const std::vector<LinkMotion>& links, const ContactForce& f,
                   ContactPoint& point) {
  const LinkMotion &a = link_of(model, point.feature.a, links), &b = link_of(model, point.feature.b, links);
  const ContactLaw law = model.contact.law(point.feature.a, point.feature.b);
  const AlongFactors along = along_factors(law, point, -f.gap);
  FrictionSpring& spring = point.friction;
  const double stiffness = along.stiffness * spring.stiffness;
  const bool slips = f.slides || f.normal == 0;
  Vector3d stretch = f.spring_stretch();
  if (slips) {
    const Vector3d v_t = f.velocity - f.n.dot(f.velocity) * f.n;
    stretch = left_over(f.friction, along.damping * spring.damping * v_t, stiffness);
    spring.on_a = in_link(a, f.p);
    spring.on_b = in_link(b, f.p + stretch);
  } else if (f.stiffer > 0) {
    spring.on_b = in_link(b, b.point(spring.on_b) - f.stiffer * f.last_stretch);
  }
  if (law.hertz) spring.last_stretch = a.R_WL.transpose() * stretch;
  return 0.5 * stiffness * stretch.squaredNorm();
}

double move_rolling_spring(const Model& model, const std::vector<LinkMotion>& links, const ContactForce& f,
                           ContactPoint& point) {
  RollingSpring& spring = point.rolling;
  if (!(spring.stiffness > 0)) return 0;
  const ContactLaw law = model.contact.law(point.feature.a, point.feature.b);
  const AlongFactors along = along_factors(law, point, -f.gap);
  const double stiffness = along.stiffness * spring.stiffness;
  const LinkMotion &a = link_of(model, point.feature.a, links), &b = link_of(model, point.feature.b, links);
  const bool slips = f.rolls || f.normal == 0;
  const Vector3d bend =
      slips ? left_over(f.torque, along.damping * spring.damping * f.rolling, stiffness) : f.spring_bend();
  const Vector3d direction = a.R_WL * spring.on_a;
  if (slips || f.stiffer > 0 || (direction - f.n).norm() > turned)
    set_rolling_spring(f.n, (f.n + bend.cross(f.n)).normalized(), a, b, spring);
  if (law.hertz) spring.last_bend = a.R_WL.transpose() * bend;
  return 0.5 * stiffness * bend.squaredNorm();
}

}  // namespace tandem::mbd
