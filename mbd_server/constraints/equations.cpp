#include "mbd_server/constraints/equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace tandem::mbd {
namespace {

// Round-off of an equation relative to the sizes of its terms: each term takes a few operations.
constexpr double round_off = 4 * std::numeric_limits<double>::epsilon();

// A direction fixed in a link, with its derivatives.
struct Direction {
  Vector3d value, rate, acceleration;
  Direction(const LinkMotion& link, const Vector3d& in_link) : value(link.R_WL * in_link) {
    const Vector3d w = link.V.head<3>(), alpha = link.A.head<3>();
    rate = w.cross(value);
    acceleration = alpha.cross(value) + w.cross(rate);
  }
};

// A point fixed in a link. Its acceleration lacks gravity, which is the same for all points.
struct Point {
  Vector3d value, rate, acceleration;
  double reach, speed;  // sizes of the terms that value and rate are summed from [m, m/s]
  Point(const LinkMotion& link, const Vector3d& p_LP) : value(link.point(p_LP)) {
    rate = link.velocity(value);
    acceleration = at_point(link.A, value) + link.V.head<3>().cross(rate);
    reach = link.p_WL.lpNorm<1>() + p_LP.lpNorm<1>();
    speed = link.V.tail<3>().lpNorm<1>() + reach * link.V.head<3>().lpNorm<1>();
  }
};

// The points of a closure on its two links.
struct Ends {
  Point a, b;
  Vector3d d, d_rate, d_acc;  // from a to b
  Ends(const Closure& c, const std::vector<LinkMotion>& links)
      : a(links[c.a], c.p_a),
        b(links[c.b], c.p_b),
        d(b.value - a.value),
        d_rate(b.rate - a.rate),
        d_acc(b.acceleration - a.acceleration) {}
};
bool is_between_points(EquationKind kind) {
  return kind != EquationKind::couple && kind != EquationKind::square;
}

double dot_acceleration(const Direction& n, const Vector3d& d, const Vector3d& d_rate,
                        const Vector3d& d_acc) {
  return n.acceleration.dot(d) + 2 * n.rate.dot(d_rate) + n.value.dot(d_acc);
}

// The angle plus the whole number of turns that brings it nearest to `expected`; the angle itself is known
// only modulo 2 pi.
double unwrapped(double angle, double expected) {
  const double turn = 2 * std::numbers::pi;
  return angle + turn * std::round((expected - angle) / turn);
}

EquationValue couple_many(const Closure& c, const std::vector<LinkMotion>& links) {
  EquationValue v;
  v.c_a.setZero(), v.c_b.setZero();
  for (const CoupledLink& term : c.terms) {
    const CoordinateMotion& q = links[term.link].coordinate;
    v.position += term.factor * q.value;
    v.velocity += term.factor * q.rate;
    v.acceleration += term.factor * q.acceleration;
    v.position_floor += round_off * std::abs(term.factor * q.value);
    v.velocity_floor += round_off * std::abs(term.factor * q.rate);
  }
  v.on_q_a = c.terms[0].factor, v.on_q_b = c.terms[1].factor;
  return v;
}

// q_b = f(q_a) - f(0)
EquationValue follow_cam(const PeriodicCurve& cam, const CoordinateMotion& a, const CoordinateMotion& b) {
  EquationValue v;
  v.c_a.setZero(), v.c_b.setZero();
  const PeriodicCurve::Value f = cam.at(a.value), start = cam.at(0);
  v.position = b.value - (f.value - start.value);
  v.velocity = b.rate - f.first * a.rate;
  v.acceleration = b.acceleration - f.first * a.acceleration - f.second * a.rate * a.rate;
  v.on_q_a = -f.first, v.on_q_b = 1, v.on_q_a_per_q_a = -f.second;
  v.position_floor = round_off * (std::abs(b.value) + std::abs(f.value) + std::abs(start.value) +
                                  std::abs(f.first * a.value));
  v.velocity_floor = round_off * (std::abs(b.rate) + std::abs(f.first * a.rate));
  return v;
}

EquationValue between_points(const Closure& c, const Equation& e, const std::vector<LinkMotion>& links,
                             const Ends& ends) {
  const LinkMotion &a = links[c.a], &b = links[c.b];
  const Point &pa = ends.a, &pb = ends.b;
  const Vector3d &d = ends.d, &d_rate = ends.d_rate, &d_acc = ends.d_acc;
  EquationValue v;
  v.position_floor = round_off * (pa.reach + pb.reach);
  v.velocity_floor = round_off * (pa.speed + pb.speed);
  switch (e.kind) {
    case EquationKind::point:
      v.position = e.on_a.dot(d);
      v.velocity = e.on_a.dot(d_rate);
      v.acceleration = e.on_a.dot(d_acc);
      v.c_a = wrench_at(pa.value, e.on_a);
      v.c_b = wrench_at(pb.value, e.on_a);
      break;
    case EquationKind::distance:
      v.position = (d.squaredNorm() - c.length * c.length) / (2 * c.length);
      v.velocity = d.dot(d_rate) / c.length;
      v.acceleration = (d_rate.squaredNorm() + d.dot(d_acc)) / c.length;
      v.c_a = v.c_b = wrench_at(pb.value, d / c.length);
      break;
    default: {  // slide, screw
      const Direction n(a, e.on_a);
      v.position = n.value.dot(d);
      v.velocity = n.rate.dot(d) + n.value.dot(d_rate);
      v.acceleration = dot_acceleration(n, d, d_rate, d_acc);
      v.c_a = v.c_b = wrench_at(pb.value, n.value);
      if (e.kind == EquationKind::slide) break;
      const Vector3d w = b.V.head<3>() - a.V.head<3>(), alpha = b.A.head<3>() - a.A.head<3>();
      v.position -= c.pitch * unwrapped(angle(c, links), c.pitch != 0 ? v.position / c.pitch : 0);
      v.velocity -= c.pitch * n.value.dot(w);
      v.acceleration -= c.pitch * (n.rate.dot(w) + n.value.dot(alpha));
      v.c_a.head<3>() -= c.pitch * n.value;
      v.c_b = v.c_a;
    }
  }
  return v;
}

}  // namespace

double angle(const Closure& c, const std::vector<LinkMotion>& links) {
  const LinkMotion &a = links[c.a], &b = links[c.b];
  const Vector3d e1 = a.R_WL * c.across_a, e2 = a.R_WL * c.axis.cross(c.across_a), f = b.R_WL * c.across_b;
  return std::atan2(e2.dot(f), e1.dot(f));
}

double travel(const Closure& c, const std::vector<LinkMotion>& links) {
  const LinkMotion &a = links[c.a], &b = links[c.b];
  return (a.R_WL * c.axis).dot(b.point(c.p_b) - a.point(c.p_a));
}

EquationValue evaluate(const Closure& c, const Equation& e, const std::vector<LinkMotion>& links) {
  const LinkMotion &a = links[c.a], &b = links[c.b];
  EquationValue v;
  if (e.kind == EquationKind::couple && !c.terms.empty()) return couple_many(c, links);
  if (e.kind == EquationKind::couple && c.cam) return follow_cam(*c.cam, a.coordinate, b.coordinate);
  if (e.kind == EquationKind::couple) {
    v.position = b.coordinate.value - c.ratio * a.coordinate.value;
    v.velocity = b.coordinate.rate - c.ratio * a.coordinate.rate;
    v.acceleration = b.coordinate.acceleration - c.ratio * a.coordinate.acceleration;
    v.c_a.setZero(), v.c_b.setZero();
    v.on_q_a = -c.ratio, v.on_q_b = 1;
    v.position_floor = round_off * (std::abs(b.coordinate.value) + std::abs(c.ratio * a.coordinate.value));
    v.velocity_floor = round_off * (std::abs(b.coordinate.rate) + std::abs(c.ratio * a.coordinate.rate));
    return v;
  }
  if (e.kind == EquationKind::square) {
    const Direction u(a, e.on_a), w(b, e.on_b);
    v.position = u.value.dot(w.value);
    v.velocity = u.rate.dot(w.value) + u.value.dot(w.rate);
    v.acceleration = dot_acceleration(u, w.value, w.rate, w.acceleration);
    v.c_a = v.c_b = spatial(w.value.cross(u.value), Vector3d::Zero());
    v.position_floor = round_off;
    v.velocity_floor = round_off * (a.V.head<3>().lpNorm<1>() + b.V.head<3>().lpNorm<1>());
    return v;
  }
  return between_points(c, e, links, Ends(c, links));
}

void evaluate(const Closure& c, const std::vector<LinkMotion>& links, EquationValue* values) {
  std::optional<Ends> ends;
  for (std::size_t k = 0; k < c.equations.size(); ++k) {
    const Equation& e = c.equations[k];
    if (!is_between_points(e.kind)) {
      values[k] = evaluate(c, e, links);
      continue;
    }
    if (!ends) ends.emplace(c, links);
    values[k] = between_points(c, e, links, *ends);
  }
}

// With the rotations w_a, w_b in psi, a vector u fixed in a changes by du = w_a x u, a vector v fixed in b by
// dv = w_b x v, and a point p moves by at_point(psi, p).
void add_geometric_stiffness(const Closure& c, const Equation& e, const std::vector<LinkMotion>& links,
                             double lambda, GeometricStiffness& t) {
  if (!rotates_with_links(e.kind)) return;
  const LinkMotion &a = links[c.a], &b = links[c.b];
  if (e.kind == EquationKind::square) {  // v x u
    const Matrix3d u = skew(a.R_WL * e.on_a), v = skew(b.R_WL * e.on_b);
    t.by_b.topLeftCorner<3, 3>() += lambda * u * v;
    t.by_a.topLeftCorner<3, 3>() -= lambda * v * u;
    return;
  }
  const Vector3d p_a = a.point(c.p_a), p_b = b.point(c.p_b);
  const Eigen::Matrix<double, 3, 6> dp_b = at_point_matrix(p_b);
  if (e.kind == EquationKind::distance) {  // [p_b x d; d] / L
    const Matrix3d d = skew(p_b - p_a) / c.length, p = skew(p_b) / c.length;
    const Eigen::Matrix<double, 3, 6> dp_a = at_point_matrix(p_a);
    t.by_b.topRows<3>() += lambda * (p - d) * dp_b;
    t.by_b.bottomRows<3>() += lambda / c.length * dp_b;
    t.by_a.topRows<3>() -= lambda * p * dp_a;
    t.by_a.bottomRows<3>() -= lambda / c.length * dp_a;
    return;
  }
  // slide, screw: [p_b x n - pitch n; n]
  const Matrix3d n = skew(a.R_WL * e.on_a);
  t.by_b.topRows<3>() -= lambda * n * dp_b;
  t.by_a.topLeftCorner<3, 3>() -= lambda * skew(p_b) * n;
  t.by_a.bottomLeftCorner<3, 3>() -= lambda * n;
  if (e.kind == EquationKind::screw) t.by_a.topLeftCorner<3, 3>() += lambda * c.pitch * n;
}

}  // namespace tandem::mbd
