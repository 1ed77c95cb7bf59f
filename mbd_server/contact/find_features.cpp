// Features of two shapes: corners on planes; ends and lines of capsules; of two polytopes the axis along
// which they are farthest apart, and the part of a face of one above a face of the other.
#include <algorithm>
#include <cmath>
#include <optional>

#include "mbd_server/contact/mesh_features.hpp"
#include "mbd_server/contact/solid.hpp"

namespace tandem::mbd {
namespace {

using Kind = ContactShape::Kind;
using Points = std::vector<Vector3d>;

// Ends of two parallel rods within this share of their length are opposite each other.
constexpr double same_end = 1e-6;
// The axis of the last step stays unless another one is better by this share of the smaller thickness.
constexpr double hysteresis = 0.02;
// Points of one face nearer to each other than this share of its size differ by rounding.
constexpr double same_point = 1e-8;
// Edges of two faces that cross at a smaller angle lie on each other: they are as near to each other as
// points that bear as one, and where they cross jumps along them from step to step [rad].
constexpr double least_crossing = 1e-4;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

class FeatureFinder {
 public:
  FeatureFinder(const Solid& a, const Solid& b, double reach, std::int64_t preferred,
                std::vector<ContactFeature>& out, int& apart)
      : a_(a), b_(b), reach_(reach), preferred_(preferred), out_(out), apart_(apart) {}

  // The corners of `a`, its ends or its centre on the plane b.
  void on_plane(const Solid& a, const Solid& plane) {
    const Vector3d n = plane.link.R_WL * plane.shape.axes.col(2), o = plane.centre;
    for (std::size_t i = 0; i < a.points.size(); ++i) {
      if (n.dot(a.points[i] - o) - a.shape.radius > reach_) continue;
      if (a.shape.kind == Kind::cylinder) {
        ContactFeature f;
        f.kind = ContactFeature::Kind::rim_on_plane;
        f.a = a.index, f.b = plane.index;
        f.code = code_of(Family::corner, static_cast<std::int64_t>(i));
        f.place_a = a.shape.points[i], f.axis_a = a.shape.axis();
        f.radius_a = a.shape.radius;
        f.place_b = plane.shape.centre, f.axis_b = plane.shape.axes.col(2);
        out_.push_back(f);
        continue;
      }
      ball_on_plane(a, a.shape.points[i], a.shape.radius, plane, plane.shape.centre, plane.shape.axes.col(2),
                    code_of(Family::corner, static_cast<std::int64_t>(i)));
    }
  }

  // A ball of `a` on the whole of the round shape or box b.
  void ball_on_shape(const Solid& a, std::size_t point, double radius, const Solid& b, Family family) {
    ContactFeature f;
    f.kind = ContactFeature::Kind::shape;
    f.a = a.index, f.b = b.index;
    f.code = code_of(family, static_cast<std::int64_t>(point));
    f.place_a = a.shape.points[point];
    f.radius_a = radius;
    f.radius_b = b.shape.kind == Kind::box ? 0 : b.shape.radius;
    out_.push_back(f);
  }

  // A ball of `a` on the nearest face, edge or corner of a hull.
  void ball_on_hull(const Solid& a, std::size_t point, const Solid& hull) {
    const Vector3d c = a.points[point];
    const double radius = a.shape.radius;
    double best = -HUGE_VAL;
    std::size_t face = 0;
    for (std::size_t k = 0; k < hull.shape.faces.size(); ++k) {
      const double s = hull.normal(k).dot(c - hull.on_face(k));
      if (s > best) best = s, face = k;
    }
    if (best - radius > reach_) return;
    const auto inside = [&](std::size_t k) {
      const std::vector<int>& corners = hull.shape.faces[k].corners;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3d p = hull.points[at(corners[i])],
                       q = hull.points[at(corners[(i + 1) % corners.size()])];
        if ((q - p).cross(hull.normal(k)).dot(c - p) > 0) return false;
      }
      return true;
    };
    if (best <= 0 || inside(face)) {
      ball_on_plane(a, a.shape.points[point], radius, hull,
                    hull.shape.points[at(hull.shape.faces[face].corners[0])], hull.shape.faces[face].normal,
                    code_of(Family::hull, static_cast<std::int64_t>(point)));
      return;
    }
    // Outside, and above no face in front: the nearest point of all faces' edges, or a face that it is above.
    double nearest = HUGE_VAL;
    ContactFeature f;
    f.a = a.index, f.b = hull.index;
    f.code = code_of(Family::hull, static_cast<std::int64_t>(point));
    f.place_a = a.shape.points[point];
    f.radius_a = radius;
    for (std::size_t k = 0; k < hull.shape.faces.size(); ++k) {
      const double s = hull.normal(k).dot(c - hull.on_face(k));
      if (s <= 0 || s >= nearest || !inside(k)) continue;
      nearest = s;
      f.kind = ContactFeature::Kind::plane;
      f.place_b = hull.shape.points[at(hull.shape.faces[k].corners[0])],
      f.axis_b = hull.shape.faces[k].normal;
    }
    for (const ContactShape::Edge& e : hull.shape.edges) {
      const Vector3d p = hull.points[at(e.from)], d = hull.points[at(e.to)] - p;
      const double s = d.dot(c - p) / d.squaredNorm();
      const double distance = (c - p - std::clamp(s, 0., 1.) * d).norm();
      if (!(distance < nearest)) continue;
      nearest = distance;
      f.place_b = hull.shape.points[at(s >= 1 ? e.to : e.from)];
      if (s > 0 && s < 1)
        f.kind = ContactFeature::Kind::line, f.axis_b = hull.turned_back(d.normalized());
      else
        f.kind = ContactFeature::Kind::point;
    }
    if (nearest - radius <= reach_) out_.push_back(f);
  }

  // The axis of the capsule `a` on the edges of b, and the corners of b on the capsule, each where they are
  // nearest to each other.
  void rod_on_edges(const Solid& rod, const Solid& b) {
    const Vector3d p = rod.points[0], d = rod.points[1] - p;
    for (std::size_t k = 0; k < b.shape.edges.size(); ++k) {
      const ContactShape::Edge& e = b.shape.edges[k];
      const Vector3d q = b.points[at(e.from)], g = b.points[at(e.to)] - q, N = d.cross(g);
      if (N.norm() <= parallel * d.norm() * g.norm()) continue;
      const Vector3d D = q - p;
      const double s = D.cross(g).dot(N) / N.squaredNorm(), t = D.cross(d).dot(N) / N.squaredNorm();
      if (s <= 0 || s >= 1 || t <= 0 || t >= 1) continue;
      // Out of b: towards the axis, between the normals of the two faces. A rod that lies on a face across
      // its edge slopes to either side.
      Vector3d out = p + s * d - q - t * g;
      if (b.shape.is_polytope()) {
        const Vector3d n0 = b.normal(at(e.faces[0])), n1 = b.normal(at(e.faces[1]));
        const Vector3d w0 = g.cross(n0), w1 = g.cross(n1);
        const Vector3d in0 = w0.dot(b.centre - q) > 0 ? w0 : Vector3d(-w0),
                       in1 = w1.dot(b.centre - q) > 0 ? w1 : Vector3d(-w1);
        const double slack = tilt_of_edge * out.norm();
        if (in0.dot(out) > slack * in0.norm() || in1.dot(out) > slack * in1.norm()) continue;
      }
      if (out.norm() - rod.shape.radius - b.shape.radius > reach_) continue;
      lines(rod, 0, b, k, out.dot(N) > 0 ? -1 : 1, code_of(Family::lines, 0, static_cast<std::int64_t>(k)));
    }
  }
  void corners_on_rod(const Solid& b, const Solid& rod) {
    const Vector3d p = rod.points[0], d = rod.points[1] - p;
    for (std::size_t i = 0; i < b.points.size(); ++i) {
      const Vector3d c = b.points[i];
      const double s = d.dot(c - p) / d.squaredNorm();
      if (s <= 0 || s >= 1) continue;  // an end touches as a ball
      const Vector3d out = p + s * d - c;
      if (out.norm() - rod.shape.radius > reach_) continue;
      const bool outside = std::ranges::all_of(b.shape.edges, [&](const ContactShape::Edge& e) {
        const int other = e.from == static_cast<int>(i) ? e.to : e.to == static_cast<int>(i) ? e.from : none;
        if (other == none) return true;
        const Vector3d along = b.points[at(other)] - c;
        return out.dot(along) <= tilt_of_edge * out.norm() * along.norm();
      });
      if (outside) ball_on_shape(b, i, 0, rod, Family::end_b);
    }
  }

  void rods() {
    const auto ends = [&](const Solid& one, const Solid& two, Family family) {
      const Vector3d p = two.points[0], d = two.points[1] - p;
      for (std::size_t i = 0; i < 2; ++i) {
        const double s = d.dot(one.points[i] - p) / d.squaredNorm();
        // Two ends that are nearest to each other touch once: also where both rods have one length, and
        // rounding decides which end is beyond the other.
        if (family == Family::end_b && (s <= same_end || s >= 1 - same_end)) continue;
        ball_on_shape(one, i, one.shape.radius, two, family);
      }
    };
    ends(a_, b_, Family::end_a);
    ends(b_, a_, Family::end_b);
    rod_on_edges(a_, b_);
  }

  void polytopes() {
    struct Axis {
      double apart = -HUGE_VAL;
      std::int64_t code = -1;
      int kind = 0;  // face of a, of b, edges
      std::size_t i = 0, k = 0;
    } best, kept;
    const auto consider = [&](double apart, std::int64_t code, int kind, std::size_t i, std::size_t k,
                              double bonus) {
      if (apart + bonus > best.apart) best = {apart + bonus, code, kind, i, k};
      if (code == preferred_) kept = {apart, code, kind, i, k};
    };
    const double slack = hysteresis * std::min(a_.shape.thickness, b_.shape.thickness);
    const std::size_t faces_a = a_.shape.faces.size(), faces_b = b_.shape.faces.size();
    // The distance along the normal of a face of a, then of b, and its bonus.
    const auto along = [&](std::size_t face) {
      const bool of_a = face < faces_a;
      const Solid &base = of_a ? a_ : b_, &other = of_a ? b_ : a_;
      const std::size_t i = of_a ? face : face - faces_a;
      const Vector3d& n = base.normal(i);
      return std::pair(other.lowest(n) - n.dot(base.on_face(i)), of_a ? slack : slack * (1 - 1e-3));
    };
    const auto separates = [&](double apart, double bonus) { return apart + bonus - slack > reach_; };
    // Farther apart along two edges than that, no face bears.
    const double beyond = reach_ + 1.01 * slack;
    const std::size_t faces = faces_a + faces_b, edges_b = b_.shape.edges.size();
    if (apart_ != none) {
      const std::size_t axis = at(apart_);
      if (axis < faces) {
        if (const auto [apart, bonus] = along(axis); separates(apart, bonus)) return;
      } else if (const std::size_t i = (axis - faces) / edges_b, k = (axis - faces) % edges_b; facing(i, k)) {
        if (const auto apart = between_edges(i, k); apart && *apart > beyond) return;
      }
      apart_ = none;
    }
    for (std::size_t face = 0; face < faces; ++face) {
      const auto [apart, bonus] = along(face);
      if (separates(apart, bonus)) {
        apart_ = static_cast<int>(face);
        return;
      }
      const bool of_a = face < faces_a;
      const std::size_t i = of_a ? face : face - faces_a;
      consider(apart, code_of(of_a ? Family::face_a : Family::face_b, static_cast<std::int64_t>(i)),
               of_a ? 0 : 1, i, 0, bonus);
    }
    for_each_facing([&](std::size_t i, std::size_t k) {
      if (const auto apart = between_edges(i, k))
        consider(*apart, code_of(Family::lines, static_cast<std::int64_t>(i), static_cast<std::int64_t>(k)),
                 2, i, k, 0);
    });
    if (best.apart - (best.kind == 2 ? 0 : slack) > reach_) {
      if (best.kind == 2 && best.apart > beyond) apart_ = static_cast<int>(faces + best.i * edges_b + best.k);
      return;
    }
    if (kept.code >= 0 && kept.apart + slack >= best.apart - slack) best = kept;
    if (best.kind == 0) return face_on_face(a_, best.i, b_, best.code);
    if (best.kind == 1) return face_on_face(b_, best.i, a_, best.code);
    const ContactShape::Edge &e = a_.shape.edges[best.i], &g = b_.shape.edges[best.k];
    const Vector3d p = a_.points[at(e.from)];
    const Vector3d N = (a_.points[at(e.to)] - p).cross(b_.points[at(g.to)] - b_.points[at(g.from)]);
    lines(a_, best.i, b_, best.k, N.dot(p - a_.centre) < 0 ? -1 : 1, best.code);
  }

 private:
  void ball_on_plane(const Solid& a, const Vector3d& local, double radius, const Solid& b,
                     const Vector3d& place, const Vector3d& normal, std::int64_t code) {
    ContactFeature f;
    f.kind = ContactFeature::Kind::plane;
    f.a = a.index, f.b = b.index;
    f.code = code;
    f.place_a = local;
    f.radius_a = radius;
    f.place_b = place, f.axis_b = normal;
    out_.push_back(f);
  }

  void lines(const Solid& a, std::size_t i, const Solid& b, std::size_t k, double sign, std::int64_t code) {
    const ContactShape::Edge &e = a.shape.edges[i], &g = b.shape.edges[k];
    ContactFeature f;
    f.kind = ContactFeature::Kind::lines;
    f.a = a.index, f.b = b.index;
    f.code = code;
    f.place_a = a.shape.points[at(e.from)];
    f.axis_a = sign * (a.shape.points[at(e.to)] - f.place_a).normalized();
    f.place_b = b.shape.points[at(g.from)];
    f.axis_b = (b.shape.points[at(g.to)] - f.place_b).normalized();
    f.radius_a = a.shape.radius, f.radius_b = b.shape.radius;
    out_.push_back(f);
  }

  // Distance of two edges across both; none: they are parallel.
  std::optional<double> between_edges(std::size_t i, std::size_t k) const {
    const ContactShape::Edge &e = a_.shape.edges[i], &g = b_.shape.edges[k];
    const Vector3d p = a_.points[at(e.from)], q = b_.points[at(g.from)], u = a_.points[at(e.to)] - p,
                   v = b_.points[at(g.to)] - q;
    Vector3d n = u.cross(v);
    if (n.norm() <= parallel * u.norm() * v.norm()) return {};
    n.normalize();
    if (n.dot(p - a_.centre) < 0) n = -n;
    return n.dot(q - p);
  }

  static bool crosses(double cba, double dba, double adc, double bdc) {
    return cba * dba < 0 && adc * bdc < 0 && cba * bdc > 0;
  }
  bool facing(std::size_t i, std::size_t k) const {
    const auto &fa = a_.shape.edges[i].faces, &fb = b_.shape.edges[k].faces;
    const Vector3d &ba = a_.across_arc(i), &dc = b_.across_arc(k);
    return crosses(-b_.normal(at(fb[0])).dot(ba), -b_.normal(at(fb[1])).dot(ba), a_.normal(at(fa[0])).dot(dc),
                   a_.normal(at(fa[1])).dot(dc));
  }
  // Pairs of edges that may be where the two are nearest: their arcs of normals cross (Gauss map).
  template <class F>
  void for_each_facing(F&& f) const {
    const std::size_t faces_a = a_.shape.faces.size(), faces_b = b_.shape.faces.size();
    // With the normals a and b, of a_, and c and d, those of b_ turned round.
    std::vector<double> by_dc, by_ba(faces_b);  // (edges of b_, faces of a_), (faces of b_)
    by_dc.reserve(b_.shape.edges.size() * faces_a);
    for (std::size_t k = 0; k < b_.shape.edges.size(); ++k)
      for (std::size_t face = 0; face < faces_a; ++face)
        by_dc.push_back(a_.normal(face).dot(b_.across_arc(k)));
    for (std::size_t i = 0; i < a_.shape.edges.size(); ++i) {
      for (std::size_t face = 0; face < faces_b; ++face) by_ba[face] = -b_.normal(face).dot(a_.across_arc(i));
      const auto& fa = a_.shape.edges[i].faces;
      for (std::size_t k = 0; k < b_.shape.edges.size(); ++k) {
        const auto& fb = b_.shape.edges[k].faces;
        const double cba = by_ba[at(fb[0])], dba = by_ba[at(fb[1])];
        const double adc = by_dc[k * faces_a + at(fa[0])], bdc = by_dc[k * faces_a + at(fa[1])];
        if (crosses(cba, dba, adc, bdc)) f(i, k);
      }
    }
  }

  // The part of the face of `other` opposite to a face of `base` that is above it: its corners touch.
  void face_on_face(const Solid& base, std::size_t face, const Solid& other, std::int64_t code) {
    const Vector3d n = base.normal(face), o = base.on_face(face);
    std::size_t opposite = 0;
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < other.shape.faces.size(); ++k)
      if (const double c = n.dot(other.normal(k)); c < least) least = c, opposite = k;
    Points polygon;
    for (const int corner : other.shape.faces[opposite].corners) polygon.push_back(other.points[at(corner)]);
    const std::vector<int>& corners = base.shape.faces[face].corners;
    const double size = base.shape.bound;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector3d p = base.points[at(corners[i])], q = base.points[at(corners[(i + 1) % corners.size()])];
      const Vector3d out = (q - p).cross(n).normalized();
      Points cut;
      for (std::size_t m = 0; m < polygon.size(); ++m) {
        const Vector3d &x = polygon[m], &y = polygon[(m + 1) % polygon.size()];
        const double dx = out.dot(x - p) - 1e-9 * size, dy = out.dot(y - p) - 1e-9 * size;
        if (dx <= 0) cut.push_back(x);
        if ((dx <= 0) != (dy <= 0) && std::abs(dx - dy) > least_crossing * (y - x).norm())
          cut.push_back(x + dx / (dx - dy) * (y - x));
      }
      polygon = std::move(cut);
    }
    Points taken;
    for (const Vector3d& p : polygon) {
      if (n.dot(p - o) > reach_) continue;
      if (std::any_of(taken.begin(), taken.end(),
                      [&](const Vector3d& q) { return (p - q).norm() < same_point * size; }))
        continue;
      taken.push_back(p);
      ball_on_plane(other, other.local(p), 0, base, base.shape.points[at(corners[0])],
                    base.shape.faces[face].normal, code);
      out_.back().by_place = true;
    }
  }

  const Solid &a_, &b_;
  double reach_;
  std::int64_t preferred_;
  std::vector<ContactFeature>& out_;
  int& apart_;
};

// Whether shape a is touched as a mesh by b.
bool on_surface(Kind a, Kind b) {
  if (b == Kind::cylinder) return a == Kind::mesh || a == Kind::box || a == Kind::hull;
  return a == Kind::mesh && b != Kind::plane;
}

}  // namespace

double thickness_at(const Model& model, const ContactFeature& feature) {
  double least = HUGE_VAL;
  for (const int i : {feature.a, feature.b}) {
    const ContactShape& shape = model.contact.shape(i);
    if (shape.kind == Kind::plane) continue;
    const ContactShape& other = model.contact.shape(feature.a + feature.b - i);
    const bool by_face = feature.face != none && on_surface(shape.kind, other.kind);
    least = std::min(least, by_face ? shape.mesh->face(feature.face).thickness : shape.thickness);
  }
  return least;
}

void find_features(const Model& model, int one, int two, const std::vector<LinkMotion>& links, double reach,
                   std::int64_t preferred, std::vector<ContactFeature>& features, double depth) {
  for (const auto& [mesh, other] : {std::pair{one, two}, std::pair{two, one}})
    if (on_surface(model.contact.shape(mesh).kind, model.contact.shape(other).kind))
      return find_mesh_features(model, other, mesh, links, reach, depth, features);
  int apart = none;
  find_features(Solid(model, one, links), Solid(model, two, links), reach, preferred, features, apart);
}

void find_features(const Solid& a, const Solid& b, double reach, std::int64_t preferred,
                   std::vector<ContactFeature>& features, int& apart) {
  FeatureFinder finder(a, b, reach, preferred, features, apart);
  const Kind ka = a.shape.kind, kb = b.shape.kind;
  const auto ball_on = [&](const Solid& ball, const Solid& other) {
    if (other.shape.kind == Kind::hull)
      finder.ball_on_hull(ball, 0, other);
    else
      finder.ball_on_shape(ball, 0, ball.shape.radius, other, Family::corner);
  };
  const auto rod_on_polytope = [&](const Solid& rod, const Solid& other) {
    for (std::size_t i = 0; i < 2; ++i)
      if (other.shape.kind == Kind::hull)
        finder.ball_on_hull(rod, i, other);
      else
        finder.ball_on_shape(rod, i, rod.shape.radius, other, Family::end_a);
    finder.rod_on_edges(rod, other);
    finder.corners_on_rod(other, rod);
  };
  if (ka == Kind::plane) return finder.on_plane(b, a);
  if (kb == Kind::plane) return finder.on_plane(a, b);
  if (ka == Kind::sphere) return ball_on(a, b);
  if (kb == Kind::sphere) return ball_on(b, a);
  if (ka == Kind::capsule && kb == Kind::capsule) return finder.rods();
  if (ka == Kind::capsule) return rod_on_polytope(a, b);
  if (kb == Kind::capsule) return rod_on_polytope(b, a);
  finder.polytopes();
}

}  // namespace tandem::mbd
