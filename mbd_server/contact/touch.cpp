#include "mbd_server/contact/touch.hpp"

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

void set_normal(Nearest& x, const Vector3d& otherwise) {
  const Vector3d d = x.o - x.c;
  x.length = d.norm();
  x.n = x.length > 0 ? Vector3d(d / x.length) : otherwise;
}

Nearest to_plane(const ContactShape& a, const ContactShape& b, int point, const LinkMotion& link_a,
                 const LinkMotion& link_b) {
  Nearest x;
  x.c = link_a.point(a.points.empty() ? a.centre : a.points[static_cast<std::size_t>(point)]);
  x.r_a = a.radius;
  const Matrix3d axes = link_b.R_WL * b.axes;
  x.n = -axes.col(2);
  x.length = -x.n.dot(x.c - link_b.point(b.centre));
  x.o = x.c + x.length * x.n;
  x.free = 2;
  x.along = axes.leftCols<2>();
  return x;
}

Nearest to_sphere(const ContactShape& a, const ContactShape& b, const LinkMotion& link_a,
                  const LinkMotion& link_b) {
  Nearest x;
  x.c = link_a.point(a.centre);
  x.o = link_b.point(b.centre);
  x.r_a = a.radius, x.r_b = b.radius;
  set_normal(x, Vector3d::UnitZ());
  return x;
}

Nearest to_capsule(const ContactShape& a, const ContactShape& b, const LinkMotion& link_a,
                   const LinkMotion& link_b) {
  Nearest x;
  x.c = link_a.point(a.centre);
  x.r_a = a.radius, x.r_b = b.radius;
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
Nearest to_box(const ContactShape& a, const ContactShape& b, const LinkMotion& link_a,
               const LinkMotion& link_b) {
  Nearest x;
  x.c = link_a.point(a.centre);
  x.r_a = a.radius;
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

Nearest nearest(const Model& model, const ContactPair& pair, int point,
                const std::vector<LinkMotion>& links) {
  const ContactShape &a = model.contact_shapes[static_cast<std::size_t>(pair.a)],
                     &b = model.contact_shapes[static_cast<std::size_t>(pair.b)];
  const LinkMotion &link_a = links[static_cast<std::size_t>(a.link)],
                   &link_b = links[static_cast<std::size_t>(b.link)];
  switch (b.kind) {
    case ContactShape::Kind::plane:
      return to_plane(a, b, point, link_a, link_b);
    case ContactShape::Kind::capsule:
      return to_capsule(a, b, link_a, link_b);
    case ContactShape::Kind::box:
      return to_box(a, b, link_a, link_b);
    default:
      return to_sphere(a, b, link_a, link_b);
  }
}

const LinkMotion& link_of(const Model& model, int shape, const std::vector<LinkMotion>& links) {
  return links[static_cast<std::size_t>(model.contact_shapes[static_cast<std::size_t>(shape)].link)];
}

}  // namespace

double gap(const Model& model, const ContactPair& pair, int point, const std::vector<LinkMotion>& links,
           double* rate) {
  const Nearest x = nearest(model, pair, point, links);
  if (rate) *rate = x.n.dot(at_point(link_of(model, pair.b, links).V - link_of(model, pair.a, links).V, x.c));
  return x.length - x.r_a - x.r_b;
}

// b seen at c moves by dx_b; relative to b, c moves by dc = dx_a - dx_b, and o by its part along the free
// directions. The normal turns with b, and by -(1 - n n^T - along along^T) dc / length besides.
Touch touch(const Model& model, const ContactPair& pair, int point, const std::vector<LinkMotion>& links) {
  const Nearest x = nearest(model, pair, point, links);
  Touch t;
  t.n = x.n;
  t.gap = x.length - x.r_a - x.r_b;
  const double reach = x.r_a + 0.5 * t.gap;
  t.p = x.c + reach * x.n;
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
