#include "mbd_server/contact/balls_on_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/contact/features.hpp"
#include "mbd_server/contact/mesh_back.hpp"
#include "mbd_server/contact/rim.hpp"

namespace tandem::mbd {

bool BallsOnMesh::add(std::size_t i) {
  const double radius = a_.radius;
  const Vector3d c = local(a_.points[i]);
  const Vector3d margin = Vector3d::Constant(radius + reach_ + (a_.is_polytope() ? depth_ : 0) + eps_);
  mesh_.near(c - margin, c + margin, near_);
  if (near_.empty()) return false;
  hits_.clear();
  if (a_.is_polytope())
    corner_hits(i, c);
  else if (a_.kind == Kind::cylinder)
    rim_hits(c, R_ * a_.axis());
  else
    ball_hits(c, radius);
  for (const Hit& hit : hits_) add(i, hit);
  return true;
}

void BallsOnMesh::add_watch(std::size_t i) {
  ContactFeature f;
  f.kind = ContactFeature::Kind::watch;
  f.a = index_a_, f.b = index_b_;
  f.code = code_of(Family::on_mesh, static_cast<std::int64_t>(i));
  f.place_a = a_.points[i];
  f.radius_a = a_.radius;
  if (a_.kind == Kind::cylinder) f.axis_a = a_.axis();
  f.face = near_[0];
  out_.push_back(f);
}

std::optional<ContactFeature> BallsOnMesh::behind(std::size_t i) const {
  return on_back(model_, index_a_, index_b_, i, links_, near_);
}

void BallsOnMesh::plane_hit(int f, const Vector3d& c, double radius) {
  const ContactMesh::Face& face = mesh_.face(f);
  const double s = face.normal.dot(c - mesh_.on_face(f));
  hits_.push_back({ContactFeature::Kind::plane, s - radius, c - s * face.normal, face.normal, face.normal, f,
                   face.corners});
}

// Faces, edges and corners that are nearer to the centre of a ball than their neighbours are.
void BallsOnMesh::ball_hits(const Vector3d& c, double radius) {
  visited_.clear();
  for (const int f : near_) {
    const ContactMesh::Face& face = mesh_.face(f);
    const double s = face.normal.dot(c - mesh_.on_face(f));
    const Vector3d p = c - s * face.normal;
    bool inside = true;
    double nearest = HUGE_VAL, along = 0;
    std::size_t side = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d &x = mesh_.point(face.corners[k]), &y = mesh_.point(face.corners[(k + 1) % 3]);
      const Vector3d d = y - x;
      inside &= d.cross(face.normal).dot(p - x) <= eps_ * d.norm();
      const double u = std::clamp(d.dot(c - x) / d.squaredNorm(), 0., 1.);
      const double distance = (c - x - u * d).squaredNorm();
      if (distance < nearest) nearest = distance, along = u, side = k;
    }
    if (inside) {
      if (s >= 0 && s - radius <= reach_) plane_hit(f, c, radius);
      continue;
    }
    if (std::sqrt(nearest) - radius > reach_) continue;
    if (along > 0 && along < 1)
      edge_hit(f, face.edges[side], s, c, radius);
    else
      corner_hit(face.corners[along > 0 ? (side + 1) % 3 : side], f, s, c, radius);
  }
  keep_nearest();
}

void BallsOnMesh::edge_hit(int f, int e, double s, const Vector3d& c, double radius) {
  const ContactMesh::Edge& edge = mesh_.edge(e);
  if (f != edge.faces[0] || edge.bend == Bend::concave) return;
  const Vector3d x = mesh_.point(edge.from), d = (mesh_.point(edge.to) - x).normalized(),
                 q = x + d.dot(c - x) * d;
  const double distance = (c - q).norm();
  if (!(distance > 0) || outward(f, e).dot(c - q) < -eps_) return;
  if (edge.bend == Bend::border) {
    if (s < 0) return;
  } else {
    if (outward(edge.faces[1], e).dot(c - q) < -eps_) return;
    if (edge.bend == Bend::flat) {
      if (s > 0) plane_hit(f, c, radius);
      return;
    }
  }
  hits_.push_back({ContactFeature::Kind::line,
                   distance - radius,
                   q,
                   (c - q) / distance,
                   d,
                   f,
                   {edge.from, edge.to, none}});
}

void BallsOnMesh::corner_hit(int v, int f, double s, const Vector3d& c, double radius) {
  if (std::find(visited_.begin(), visited_.end(), v) != visited_.end()) return;
  const Vector3d q = mesh_.point(v), d = c - q;
  const double distance = d.norm();
  if (!(distance > 0)) return;
  bool border = false;
  double in_front = 0;
  int flat = none;
  for (const int e : mesh_.edges_at(v)) {
    const ContactMesh::Edge& edge = mesh_.edge(e);
    const Vector3d to = mesh_.point(edge.from == v ? edge.to : edge.from) - q;
    if (d.dot(to) > eps_ * to.norm()) return;
    for (const int g : edge.faces) {
      if (g == none) {
        border = true;
        continue;
      }
      const double along = mesh_.face(g).normal.dot(d);
      in_front += along;
      if (along > (1 - 1e-9) * distance && (flat == none || g < flat)) flat = g;
    }
  }
  if (!(in_front > 0) || (border && s < 0)) return;
  visited_.push_back(v);
  if (flat != none)
    plane_hit(flat, c, radius);
  else
    hits_.push_back(
        {ContactFeature::Kind::point, distance - radius, q, d / distance, d / distance, f, {v, none, none}});
}

// The circle about c across s, at an end of a cylinder.
void BallsOnMesh::rim_hits(const Vector3d& c, const Vector3d& s) {
  const double R = a_.radius;
  std::vector<int> edges;
  for (const int f : near_) {
    const ContactMesh::Face& face = mesh_.face(f);
    for (const int e : face.edges)
      if (mesh_.edge(e).bend == Bend::convex || mesh_.edge(e).bend == Bend::border) edges.push_back(e);
    const Vector3d across = face.normal - face.normal.dot(s) * s;
    const double sine = across.norm(), height = face.normal.dot(c - mesh_.on_face(f)),
                 gap = height - R * sine;
    if (gap > reach_ || height < 0 || !(sine > 0)) continue;
    const Vector3d p = c - R / sine * across - gap * face.normal;
    if (is_above(mesh_, f, p, eps_))
      hits_.push_back(
          {ContactFeature::Kind::rim_on_plane, gap, p, face.normal, face.normal, f, face.corners});
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const int e : edges) rim_on_edge(c, s, e);
  keep_nearest();
}

void BallsOnMesh::rim_on_edge(const Vector3d& c, const Vector3d& s, int g) {
  const ContactMesh::Edge& edge = mesh_.edge(g);
  const Vector3d o = mesh_.point(edge.from), d = mesh_.point(edge.to) - o, e = d.normalized();
  const double cosine = s.dot(e);
  if (std::abs(cosine) < least_rim_cosine) return;
  const double along = s.dot(c - o) / cosine;
  if (along < 0 || along > d.norm()) return;
  const Vector3d q = o + along * e, r = c - q;
  const double distance = r.norm();
  if (!(distance > 0)) return;
  const Vector3d m = r / distance, n = m - m.dot(e) / cosine * s;
  const double gap = (distance - a_.radius) / n.norm();
  if (gap > reach_) return;
  const Vector3d out = n.normalized();
  for (const int f : edge.faces)
    if (f != none && outward(f, g).dot(out) < -rounding) return;
  if (edge.bend == Bend::border && mesh_.face(edge.faces[0]).normal.dot(out) < 0) return;
  hits_.push_back(
      {ContactFeature::Kind::rim_on_line, gap, q, out, e, edge.faces[0], {edge.from, edge.to, none}});
}

bool BallsOnMesh::meet(const Hit& one, const Hit& two) {
  for (const int c : one.corners)
    if (c != none && std::find(two.corners.begin(), two.corners.end(), c) != two.corners.end()) return true;
  return false;
}

// Of hits that are parts of one smooth surface the nearest stays.
void BallsOnMesh::keep_nearest() {
  std::sort(hits_.begin(), hits_.end(),
            [](const Hit& x, const Hit& y) { return x.gap < y.gap || (x.gap == y.gap && x.face < y.face); });
  for (std::size_t i = 0; i < hits_.size(); ++i) {
    Hit& hit = hits_[i];
    hit.root = static_cast<int>(i);
    for (std::size_t k = 0; k < i; ++k)
      if (meet(hit, hits_[k]) &&
          hit.out.dot(hits_[nth(hits_[k].root)].out) >= std::cos(ContactMesh::smooth)) {
        hit.root = hits_[k].root;
        break;
      }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < hits_.size(); ++i)
    if (hits_[i].root == static_cast<int>(i)) hits_[kept++] = hits_[i];
  hits_.resize(kept);
}

// A corner of a polytope touches faces, above or below which it is.
void BallsOnMesh::corner_hits(std::size_t i, const Vector3d& c) {
  for (const int f : near_) {
    const ContactMesh::Face& face = mesh_.face(f);
    const double s = face.normal.dot(c - mesh_.on_face(f));
    if (s > reach_ + 2 * eps_ || s < -std::min(2 * face.thickness, 2 * a_.thickness)) continue;
    const Vector3d p = c - s * face.normal;
    bool inside = true;
    for (std::size_t k = 0; k < 3 && inside; ++k) {
      const double beyond = outward(f, face.edges[k]).dot(p - mesh_.point(face.corners[k]));
      if (beyond <= eps_) continue;
      // Next to a concave edge a corner is in the other face besides.
      const ContactMesh::Edge& edge = mesh_.edge(face.edges[k]);
      const int other = edge.faces[0] == f ? edge.faces[1] : edge.faces[0];
      inside = edge.bend == Bend::concave && beyond <= reach_ + depth_ &&
               mesh_.face(other).normal.dot(c - mesh_.on_face(other)) <= 0;
    }
    if (!inside || !stands_on(i, face.normal)) continue;
    plane_hit(f, c, 0);
  }
  std::sort(hits_.begin(), hits_.end(),
            [](const Hit& x, const Hit& y) { return x.gap > y.gap || (x.gap == y.gap && x.face < y.face); });
  // Inside a convex part the nearest face counts, next to a concave edge both do.
  std::size_t kept = 0;
  for (std::size_t k = 0; k < hits_.size(); ++k) {
    bool counts = true;
    for (std::size_t j = 0; j < kept && counts; ++j) {
      const Hit &one = hits_[j], &two = hits_[k];
      const bool concave = one.axis.dot(mesh_.middle(two.face) - one.foot) > eps_ &&
                           two.axis.dot(mesh_.middle(one.face) - two.foot) > eps_;
      const bool same = meet(one, two) && one.axis.dot(two.axis) >= std::cos(ContactMesh::smooth);
      if (same && concave)
        hits_[j] = two, counts = false;
      else if (same || (!concave && one.gap <= 2 * eps_ && two.gap < 0))
        counts = false;
    }
    if (counts) hits_[kept++] = hits_[k];
  }
  hits_.resize(kept);
  std::sort(hits_.begin(), hits_.end(),
            [](const Hit& x, const Hit& y) { return x.gap < y.gap || (x.gap == y.gap && x.face < y.face); });
}

// Whether the edges at a corner lead away from a surface of that normal.
bool BallsOnMesh::stands_on(std::size_t corner, const Vector3d& normal) const {
  for (const ContactShape::Edge& e : a_.edges) {
    const bool from = e.from == static_cast<int>(corner), to = e.to == static_cast<int>(corner);
    if (!from && !to) continue;
    const Vector3d d = R_ * (a_.points[nth(from ? e.to : e.from)] - a_.points[corner]);
    if (d.dot(normal) < -tilt_of_corner * d.norm()) return false;
  }
  return true;
}

void BallsOnMesh::add(std::size_t i, const Hit& hit) {
  ContactFeature f;
  f.kind = hit.kind;
  f.a = index_a_, f.b = index_b_;
  f.code = code_of(Family::on_mesh, static_cast<std::int64_t>(i));
  f.on_mesh = true;
  f.face = hit.face;
  f.place_a = a_.points[i];
  f.radius_a = a_.radius;
  if (a_.kind == Kind::cylinder) f.axis_a = a_.axis();
  f.place_b = hit.foot;
  f.axis_b = hit.axis;
  out_.push_back(f);
}

}  // namespace tandem::mbd
