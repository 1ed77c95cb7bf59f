#include "mbd_server/contact/touch.hpp"

#include "mbd_server/contact/rim.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::mbd {
namespace {

// Nearest points of a pair: the centre c of a ball of a with radius r_a, and the point o of b with radius
// r_b around it; o is that of the plane below c, of the capsule's axis, of the box or of a sphere.
struct Nearest {
  Vector3d c, o;
  double r_a = 0, r_b = 0;
  // Directions along which o moves with c, as columns in world axes, orthonormal: two in a face or in a
  // plane, one on an edge or an axis, none at a corner or a centre.
  int free = 0;
  Eigen::Matrix<double, 3, 2> along = Eigen::Matrix<double, 3, 2>::Zero();
  Vector3d n;         // from a to b
  double length = 0;  // of o - c along n: negative where c is inside b [m]
};

Nearest ball_of(const ContactFeature& f, const LinkMotion& link_a) {
  Nearest x;
  x.c = link_a.point(f.place_a);
  x.r_a = f.radius_a, x.r_b = f.radius_b;
  return x;
}

void set_normal(Nearest& x, const Vector3d& otherwise) {
  const Vector3d d = x.o - x.c;
  x.length = d.norm();
  x.n = x.length > 0 ? Vector3d(d / x.length) : otherwise;
}

Nearest to_plane(const ContactFeature& f, const LinkMotion& link_a, const LinkMotion& link_b) {
  Nearest x = ball_of(f, link_a);
  x.n = -(link_b.R_WL * f.axis_b);
  x.length = -x.n.dot(x.c - link_b.point(f.place_b));
  x.o = x.c + x.length * x.n;
  x.free = 2;
  return x;
}

Nearest to_point(const ContactFeature& f, const LinkMotion& link_a, const LinkMotion& link_b) {
  Nearest x = ball_of(f, link_a);
  x.o = link_b.point(f.place_b);
  set_normal(x, Vector3d::UnitZ());
  return x;
}

Nearest to_line(const ContactFeature& f, const LinkMotion& link_a, const LinkMotion& link_b) {
  Nearest x = ball_of(f, link_a);
  const Vector3d begin = link_b.point(f.place_b), e = link_b.R_WL * f.axis_b;
  x.o = begin + e.dot(x.c - begin) * e;
  x.free = 1, x.along.col(0) = e;
  set_normal(x, e.unitOrthogonal());
  return x;
}

Nearest to_sphere(const ContactFeature& f, const ContactShape& b, const LinkMotion& link_a,
                  const LinkMotion& link_b) {
  Nearest x = ball_of(f, link_a);
  x.o = link_b.point(b.centre);
  set_normal(x, Vector3d::UnitZ());
  return x;
}

Nearest to_capsule(const ContactFeature& f, const ContactShape& b, const LinkMotion& link_a,
                   const LinkMotion& link_b) {
  Nearest x = ball_of(f, link_a);
  const Vector3d begin = link_b.point(b.points[0]), axis = link_b.point(b.points[1]) - begin;
  const double length = axis.norm();
  const Vector3d e = axis / length;
  const double s = e.dot(x.c - begin);
  x.o = begin + std::clamp(s, 0.0, length) * e;
  if (s > 0 && s < length) x.free = 1, x.along.col(0) = e;
  set_normal(x, e.unitOrthogonal());
  return x;
}

// Outside, the point of the box nearest to c; inside, the one on the nearest face.
Nearest to_box(const ContactFeature& f, const ContactShape& b, const LinkMotion& link_a,
               const LinkMotion& link_b) {
  Nearest x = ball_of(f, link_a);
  const Matrix3d axes = link_b.R_WL * b.axes;
  const Vector3d centre = link_b.point(b.centre), local = axes.transpose() * (x.c - centre);
  Vector3d on = local.cwiseMax(-b.half_size).cwiseMin(b.half_size);
  bool is_free[3];
  for (int k = 0; k < 3; ++k) is_free[k] = std::abs(local[k]) <= b.half_size[k];
  if (is_free[0] && is_free[1] && is_free[2]) {
    int k = 0;
    (b.half_size - local.cwiseAbs()).minCoeff(&k);
    const double sign = local[k] < 0 ? -1 : 1;
    on[k] = sign * b.half_size[k];
    is_free[k] = false;
    x.n = -sign * axes.col(k);
    x.length = sign * local[k] - b.half_size[k];
    x.o = centre + axes * on;
  } else {
    x.o = centre + axes * on;
    set_normal(x, Vector3d::UnitZ());
  }
  for (int k = 0; k < 3; ++k)
    if (is_free[k]) x.along.col(x.free++) = axes.col(k);
  return x;
}

Nearest nearest(const Model& model, const ContactFeature& f, const std::vector<LinkMotion>& links) {
  const LinkMotion &a = link_of(model, f.a, links), &b = link_of(model, f.b, links);
  const ContactShape& shape = model.contact.shape(f.b);
  switch (f.kind) {
    case ContactFeature::Kind::plane:
      return to_plane(f, a, b);
    case ContactFeature::Kind::line:
      return to_line(f, a, b);
    case ContactFeature::Kind::point:
      return to_point(f, a, b);
    default:
      break;
  }
  if (shape.kind == ContactShape::Kind::capsule) return to_capsule(f, shape, a, b);
  if (shape.kind == ContactShape::Kind::box) return to_box(f, shape, a, b);
  return to_sphere(f, shape, a, b);
}

// Two lines that cross: their nearest points c and o, and the unit directions.
struct Crossing {
  Vector3d c, o, n, e_a, e_b;
  double length = 0, sine = 0;  // of o - c along n
};

Crossing crossing(const Model& model, const ContactFeature& f, const std::vector<LinkMotion>& links) {
  const LinkMotion &a = link_of(model, f.a, links), &b = link_of(model, f.b, links);
  Crossing x;
  x.e_a = a.R_WL * f.axis_a, x.e_b = b.R_WL * f.axis_b;
  const Vector3d begin = a.point(f.place_a), apart = b.point(f.place_b) - begin, N = x.e_a.cross(x.e_b);
  x.sine = N.norm();
  x.n = N / x.sine;
  x.c = begin + apart.cross(x.e_b).dot(N) / (x.sine * x.sine) * x.e_a;
  x.length = x.n.dot(apart);
  x.o = x.c + x.length * x.n;
  return x;
}

}  // namespace

double gap(const Model& model, const ContactFeature& f, const std::vector<LinkMotion>& links, double* rate) {
  Vector3d n, c;
  double length = 0;
  if (is_rim(f)) {
    const Touch t = touch_rim(model, f, links, Derivatives::without);
    n = t.n, c = t.p, length = t.gap + f.radius_a;
  } else if (f.kind == ContactFeature::Kind::lines) {
    const Crossing x = crossing(model, f, links);
    n = x.n, c = x.c, length = x.length;
  } else {
    const Nearest x = nearest(model, f, links);
    n = x.n, c = x.c, length = x.length;
  }
  if (rate) *rate = n.dot(at_point(link_of(model, f.b, links).V - link_of(model, f.a, links).V, c));
  return length - f.radius_a - f.radius_b;
}

Vector3d foot(const Model& model, const ContactFeature& f, const std::vector<LinkMotion>& links) {
  if (is_rim(f)) return foot_of_rim(model, f, links);
  const Vector3d o =
      f.kind == ContactFeature::Kind::lines ? crossing(model, f, links).o : nearest(model, f, links).o;
  return in_link(link_of(model, f.b, links), o);
}

namespace {

// With m across n and e_b, m . (c - o) stays zero, which gives the change of c along e_a.
Touch touch_lines(const Model& model, const ContactFeature& f, const std::vector<LinkMotion>& links,
                  Derivatives derivatives) {
  using Row6d = Eigen::Matrix<double, 1, 6>;
  const Crossing x = crossing(model, f, links);
  Touch t;
  t.n = x.n;
  t.gap = x.length - f.radius_a - f.radius_b;
  const double reach = f.radius_a + 0.5 * t.gap;
  t.p = x.c + reach * x.n;
  if (derivatives == Derivatives::without) return t;
  const Matrix3d across = (Matrix3d::Identity() - x.n * x.n.transpose()) / x.sine;
  t.dn_a.setZero(), t.dn_b.setZero();
  t.dn_a.leftCols<3>() = across * skew(x.e_b) * skew(x.e_a);
  t.dn_b.leftCols<3>() = -across * skew(x.e_a) * skew(x.e_b);
  const Matrix3x6d at_c = at_point_matrix(x.c), at_o = at_point_matrix(x.o);
  const Vector3d m = x.n.cross(x.e_b);
  const double along = m.dot(x.e_a);
  const Row6d slide_a = -m.transpose() * (at_c + x.length * t.dn_a) / along,
              slide_b = -m.transpose() * (x.length * t.dn_b - at_o) / along;
  const Row6d d_gap = x.n.transpose() * at_c;  // per displacement of b
  t.dp_a = at_c + x.e_a * slide_a + reach * t.dn_a - 0.5 * x.n * d_gap;
  t.dp_b = x.e_a * slide_b + reach * t.dn_b + 0.5 * x.n * d_gap;
  return t;
}

}  // namespace

// b seen at c moves by dx_b; relative to b, c moves by dc = dx_a - dx_b, and o by its part along the free
// directions. The normal turns with b, and by -(1 - n n^T - along along^T) dc / length besides.
Touch touch(const Model& model, const ContactFeature& f, const std::vector<LinkMotion>& links,
            Derivatives derivatives) {
  if (f.kind == ContactFeature::Kind::lines) return touch_lines(model, f, links, derivatives);
  if (is_rim(f)) return touch_rim(model, f, links, derivatives);
  const Nearest x = nearest(model, f, links);
  Touch t;
  t.n = x.n;
  t.gap = x.length - x.r_a - x.r_b;
  const double reach = x.r_a + 0.5 * t.gap;
  t.p = x.c + reach * x.n;
  if (derivatives == Derivatives::without) return t;
  Matrix3d turning = Matrix3d::Zero();  // of the normal, per dc
  if (x.free < 2 && x.length != 0) {
    turning = x.n * x.n.transpose() - Matrix3d::Identity();
    for (int k = 0; k < x.free; ++k) turning += x.along.col(k) * x.along.col(k).transpose();
    turning /= x.length;
  }
  const Matrix3x6d at_c = at_point_matrix(x.c);
  t.dn_a = turning * at_c;
  t.dn_b = -turning * at_c;
  t.dn_b.leftCols<3>() -= skew(x.n);
  const Eigen::Matrix<double, 1, 6> d_gap = x.n.transpose() * at_c;  // per displacement of b
  t.dp_a = at_c - 0.5 * x.n * d_gap + reach * t.dn_a;
  t.dp_b = 0.5 * x.n * d_gap + reach * t.dn_b;
  return t;
}

}  // namespace tandem::mbd
