#include "mbd_server/contact/rim.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "common/error.hpp"
#include "mbd_server/spatial/dual.hpp"

namespace tandem::mbd {
namespace {

// Displacements of a [0, 6) and of b [6, 12), each a rotation and a translation.
using Displaced = Dual<12>;
template <class T>
using Space = std::array<T, 3>;

template <class T>
T dot_of(const Space<T>& a, const Space<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
// a + s b
template <class T>
Space<T> plus(const Space<T>& a, const T& s, const Space<T>& b) {
  return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}
template <class T>
Space<T> times(const T& s, const Space<T>& a) {
  return {s * a[0], s * a[1], s * a[2]};
}

// `first`: of the displacements that move it; a direction does not translate.
void place(const Vector3d& x, int first, bool is_point, Space<double>& out) {
  (void)first, (void)is_point;
  for (std::size_t i = 0; i < 3; ++i) out[i] = x[static_cast<Eigen::Index>(i)];
}
void place(const Vector3d& x, int first, bool is_point, Space<Displaced>& out) {
  const Matrix3d turned = -skew(x);
  for (int i = 0; i < 3; ++i) {
    Displaced& d = out[static_cast<std::size_t>(i)];
    d = Displaced(x[i]);
    for (int k = 0; k < 3; ++k) d.by[first + k] = turned(i, k);
    if (is_point) d.by[first + 3 + i] = 1;
  }
}

template <class T>
struct Rim {
  Space<T> n, p, foot;  // from a to b; point of contact
  T gap;
};

template <class T>
Rim<T> rim_of(const ContactFeature& f, const LinkMotion& a, const LinkMotion& b) {
  using std::sqrt;
  Space<T> C, s, o, e;
  place(a.point(f.place_a), 0, true, C);
  place(Vector3d(a.R_WL * f.axis_a), 0, false, s);
  place(b.point(f.place_b), 6, true, o);
  place(Vector3d(b.R_WL * f.axis_b), 6, false, e);
  const T R(f.radius_a), half(0.5);
  Rim<T> rim;
  if (f.kind == ContactFeature::Kind::rim_on_plane) {
    const Space<T> w = plus(e, T(-1) * dot_of(e, s), s);
    const T sine = sqrt(dot_of(w, w));
    // Across the normal no point is the lowest.
    const Space<T> c = value_of(sine) > 0 ? plus(C, T(-1) * R / sine, w) : C;
    rim.gap = dot_of(e, plus(c, T(-1), o));
    rim.n = times(T(-1), e);
    rim.p = plus(c, half * rim.gap, rim.n);
    rim.foot = plus(c, rim.gap, rim.n);
    return rim;
  }
  const T along = dot_of(s, plus(C, T(-1), o)) / dot_of(s, e);
  const Space<T> q = plus(o, along, e), r = plus(C, T(-1), q);
  const T distance = sqrt(dot_of(r, r));
  const Space<T> m = times(T(1) / distance, r), n = plus(m, T(-1) * dot_of(m, e) / dot_of(s, e), s);
  const T size = sqrt(dot_of(n, n));
  rim.gap = (distance - R) / size;
  rim.n = times(T(-1) / size, n);
  rim.p = plus(q, half * (distance - R), m);
  rim.foot = q;
  return rim;
}

Vector3d values(const Space<double>& x) {
  return {x[0], x[1], x[2]};
}

}  // namespace

Touch touch_rim(const Model& model, const ContactFeature& f, const std::vector<LinkMotion>& links,
                Derivatives derivatives) {
  const LinkMotion &a = link_of(model, f.a, links), &b = link_of(model, f.b, links);
  const Rim<double> rim = rim_of<double>(f, a, b);
  Touch t;
  t.n = values(rim.n), t.p = values(rim.p), t.gap = rim.gap;
  if (f.kind == ContactFeature::Kind::rim_on_plane && t.gap < 0 &&
      !((a.R_WL * f.axis_a).cross(b.R_WL * f.axis_b).norm() > least_rim_sine))
    throw Error(
        ErrorCode::numerics,
        fmt::format("{} lies with its flat end on {}: cylinders touch as wheels do, with their round side",
                    model.contact.shape(f.a).name, model.contact.shape(f.b).name),
        "mbd.contact", "give it a convex_hull as its shape of contact");
  if (derivatives == Derivatives::without) return t;
  const Rim<Displaced> moved = rim_of<Displaced>(f, a, b);
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    t.dn_a.row(i) = moved.n[k].by.head<6>(), t.dn_b.row(i) = moved.n[k].by.tail<6>();
    t.dp_a.row(i) = moved.p[k].by.head<6>(), t.dp_b.row(i) = moved.p[k].by.tail<6>();
  }
  return t;
}

Vector3d foot_of_rim(const Model& model, const ContactFeature& f, const std::vector<LinkMotion>& links) {
  const LinkMotion& b = link_of(model, f.b, links);
  return in_link(b, values(rim_of<double>(f, link_of(model, f.a, links), b).foot));
}

}  // namespace tandem::mbd
