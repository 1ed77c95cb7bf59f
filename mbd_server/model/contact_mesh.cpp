#include "mbd_server/model/contact_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

constexpr int leaf = 4;  // faces
// A ray that passes an edge by less than this share of its length meets it.
constexpr double on_edge = 1e-9;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}
std::string text_of(const Vector3d& p) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", p.x(), p.y(), p.z());
}

}  // namespace

ContactMesh::ContactMesh(const std::vector<Vector3d>& vertices, const std::vector<Vector3d>& in_file,
                         const std::vector<std::array<std::uint32_t, 3>>& triangles,
                         const std::string& path) {
  if (triangles.size() > most_triangles)
    throw Error(ErrorCode::scene,
                fmt::format("the surface has {} triangles, and contact of bodies is for up to {}",
                            triangles.size(), most_triangles),
                path, "make the mesh coarser");
  weld(vertices, in_file, triangles, path);
  find_corners();
  order_.resize(faces_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<int>(i);
  build(0, static_cast<int>(order_.size()));
  measure_thickness();
  centre_ = 0.5 * (nodes_[0].low + nodes_[0].high);
  for (const Vector3d& p : points_) bound_ = std::max(bound_, (p - centre_).norm());
  if (!closed_) return;
  double volume = 0;
  for (const Face& f : faces_)
    volume += (point(f.corners[0]) - centre_)
                  .dot((point(f.corners[1]) - centre_).cross(point(f.corners[2]) - centre_));
  if (!(volume > 0))
    throw Error(ErrorCode::scene,
                "the triangles wind clockwise as seen from outside: the solid would be outside", path,
                "reverse the winding of the mesh");
}

void ContactMesh::weld(const std::vector<Vector3d>& vertices, const std::vector<Vector3d>& in_file,
                       const std::vector<std::array<std::uint32_t, 3>>& triangles, const std::string& path) {
  const auto less = [](const Vector3d& a, const Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::map<Vector3d, int, decltype(less)> known(less);
  std::vector<int> number(vertices.size());
  std::vector<Vector3d> points_in_file;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto [at, is_new] = known.try_emplace(vertices[i], static_cast<int>(points_.size()));
    if (is_new) points_.push_back(vertices[i]), points_in_file.push_back(in_file.at(i));
    number[i] = at->second;
  }
  for (const auto& triangle : triangles) {
    Face face;
    for (std::size_t i = 0; i < 3; ++i) face.corners[i] = number.at(triangle[i]);
    const Vector3d a = point(face.corners[1]) - point(face.corners[0]),
                   b = point(face.corners[2]) - point(face.corners[0]), n = a.cross(b);
    const double longest2 = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    if (!(n.norm() > 1e-12 * longest2))
      throw Error(
          ErrorCode::scene,
          "a triangle at " + text_of(points_in_file[index(face.corners[0])]) + " of the file has no area",
          path, "remove triangles without area");
    face.normal = n.normalized();
    faces_.push_back(face);
  }
  join(points_in_file, path);
}

void ContactMesh::join(const std::vector<Vector3d>& in_file, const std::string& path) {
  std::map<std::pair<int, int>, int> known;
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      const int from = faces_[f].corners[i], to = faces_[f].corners[(i + 1) % 3];
      const auto [at, is_new] = known.try_emplace(std::minmax(from, to), static_cast<int>(edges_.size()));
      faces_[f].edges[i] = at->second;
      if (is_new) {
        edges_.push_back({from, to, {static_cast<int>(f), none}});
        continue;
      }
      Edge& edge = edges_[index(at->second)];
      const std::string where = "the edge from " + text_of(in_file[index(from)]) + " to " +
                                text_of(in_file[index(to)]) + " of the file";
      if (edge.faces[1] != none)
        throw Error(ErrorCode::scene, where + " belongs to more than two triangles", path,
                    "separate the parts that meet there, as shapes of their own");
      if (edge.from == from)
        throw Error(ErrorCode::scene, where + " has triangles of opposite winding at its two sides", path,
                    "let all triangles wind counter-clockwise as seen from outside");
      edge.faces[1] = static_cast<int>(f);
    }
  for (Edge& edge : edges_) {
    if (edge.faces[1] == none) {
      closed_ = false;
      continue;
    }
    const Vector3d a = face(edge.faces[0]).normal, b = face(edge.faces[1]).normal;
    const double sine = a.cross(b).dot((point(edge.to) - point(edge.from)).normalized()),
                 angle = std::atan2(sine, a.dot(b));
    edge.bend = std::abs(angle) < flat ? Bend::flat : angle > 0 ? Bend::convex : Bend::concave;
    edge.smooth = std::abs(angle) < smooth;
  }
}

void ContactMesh::find_corners() {
  std::vector<int>& first = first_at_corner_;
  first.assign(points_.size() + 1, 0);
  for (const Edge& e : edges_) ++first[index(e.from) + 1], ++first[index(e.to) + 1];
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  at_corner_.resize(index(first.back()));
  std::vector<int> next(first.begin(), first.end() - 1);
  for (std::size_t e = 0; e < edges_.size(); ++e)
    for (const int corner : {edges_[e].from, edges_[e].to})
      at_corner_[index(next[index(corner)]++)] = static_cast<int>(e);
  sticks_out_.assign(points_.size(), false);
  for (std::size_t c = 0; c < points_.size(); ++c) {
    std::vector<Vector3d> bent;
    bool out = true;
    for (const int e : edges_at(static_cast<int>(c))) {
      const Edge& at = edge(e);
      if (at.bend == Bend::concave) out = false;
      if (at.bend == Bend::flat) continue;
      const Vector3d other = point(at.from == static_cast<int>(c) ? at.to : at.from);
      bent.push_back((other - points_[c]).normalized());
    }
    const bool straight = bent.size() == 2 && bent[0].dot(bent[1]) < -std::cos(flat);
    sticks_out_[c] = out && bent.size() > 1 && !straight;
  }
}

std::span<const int> ContactMesh::edges_at(int corner) const {
  const auto begin = at_corner_.begin() + first_at_corner_[index(corner)],
             end = at_corner_.begin() + first_at_corner_[index(corner) + 1];
  return {begin, end};
}

Vector3d ContactMesh::middle(int f) const {
  const auto& c = face(f).corners;
  return (point(c[0]) + point(c[1]) + point(c[2])) / 3;
}

int ContactMesh::build(int first, int count) {
  Node node;
  node.low.setConstant(HUGE_VAL), node.high.setConstant(-HUGE_VAL);
  Vector3d low = node.low, high = node.high;  // of the middles
  for (int i = first; i < first + count; ++i) {
    const int f = order_[index(i)];
    for (const int c : face(f).corners)
      node.low = node.low.cwiseMin(point(c)), node.high = node.high.cwiseMax(point(c));
    low = low.cwiseMin(middle(f)), high = high.cwiseMax(middle(f));
  }
  node.first = first;
  node.count = count <= leaf ? count : 0;
  const int at = static_cast<int>(nodes_.size());
  nodes_.push_back(node);
  if (node.count > 0) return at;
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
                   [&](int a, int b) {
                     const double x = middle(a)[axis], y = middle(b)[axis];
                     return x < y || (x == y && a < b);
                   });
  const int left = build(first, half), right = build(first + half, count - half);
  nodes_[index(at)].left = left, nodes_[index(at)].right = right;
  return at;
}

void ContactMesh::near(const Vector3d& low, const Vector3d& high, std::vector<int>& found) const {
  found.clear();
  std::vector<int> open{0};
  while (!open.empty()) {
    const Node& node = nodes_[index(open.back())];
    open.pop_back();
    if ((node.low.array() > high.array()).any() || (node.high.array() < low.array()).any()) continue;
    if (node.count == 0) {
      open.push_back(node.right), open.push_back(node.left);
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int f = order_[index(i)];
      Vector3d a = point(face(f).corners[0]), b = a;
      for (const int c : face(f).corners) a = a.cwiseMin(point(c)), b = b.cwiseMax(point(c));
      if ((a.array() > high.array()).any() || (b.array() < low.array()).any()) continue;
      found.push_back(f);
    }
  }
  std::sort(found.begin(), found.end());
}

template <class Hit>
void ContactMesh::cast(const Vector3d& from, const Vector3d& along, const Hit& hit) const {
  std::vector<int> open{0};
  while (!open.empty()) {
    const Node& node = nodes_[index(open.back())];
    open.pop_back();
    double enter = 0, leave = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
      if (along[k] == 0) {
        if (from[k] < node.low[k] || from[k] > node.high[k]) leave = -1;
        continue;
      }
      const double s = (node.low[k] - from[k]) / along[k], t = (node.high[k] - from[k]) / along[k];
      enter = std::max(enter, std::min(s, t)), leave = std::min(leave, std::max(s, t));
    }
    if (enter > leave + on_edge * std::abs(leave)) continue;
    if (node.count == 0) {
      open.push_back(node.right), open.push_back(node.left);
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int f = order_[index(i)];
      const double across = face(f).normal.dot(along);
      if (across == 0) continue;
      const double distance = face(f).normal.dot(on_face(f) - from) / across;
      if (!(distance > 0)) continue;
      const Vector3d p = from + distance * along;
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3d &a = point(face(f).corners[k]), &b = point(face(f).corners[(k + 1) % 3]);
        inside &= (b - a).cross(p - a).dot(face(f).normal) >= -on_edge * (b - a).squaredNorm();
      }
      if (inside) hit(distance, f);
    }
  }
}

std::pair<double, int> ContactMesh::distance(const Vector3d& p) const {
  std::pair<double, int> nearest{HUGE_VAL, none};
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Face& at = faces_[f];
    const double height = at.normal.dot(p - point(at.corners[0]));
    bool above = true;
    double d = HUGE_VAL;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d &a = point(at.corners[k]), e = point(at.corners[(k + 1) % 3]) - a;
      above &= e.cross(p - a).dot(at.normal) >= 0;
      const double along = std::clamp(e.dot(p - a) / e.squaredNorm(), 0.0, 1.0);
      d = std::min(d, (p - a - along * e).norm());
    }
    if (above) d = std::abs(height);
    if (d < nearest.first) nearest = {d, static_cast<int>(f)};
  }
  return nearest;
}

void ContactMesh::meet(const Vector3d& from, const Vector3d& along, std::vector<Crossing>& crossings) const {
  crossings.clear();
  cast(from, along, [&](double distance, int f) { crossings.push_back({distance, f}); });
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return a.distance < b.distance || (a.distance == b.distance && a.face < b.face);
  });
}

void ContactMesh::measure_thickness() {
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Vector3d inward = -faces_[f].normal;
    double nearest = std::numeric_limits<double>::infinity();
    cast(middle(static_cast<int>(f)), inward, [&](double distance, int other) {
      if (other != static_cast<int>(f) && face(other).normal.dot(inward) > 0)
        nearest = std::min(nearest, distance);
    });
    faces_[f].thickness = 0.5 * nearest;
  }
}

// The nearest face that a ray meets shows its back from inside. Of several directions most decide, as a ray
// may meet an edge.
bool ContactMesh::encloses(const Vector3d& p) const {
  if (!closed_) return false;
  int inside = 0;
  for (const Vector3d& along :
       {Vector3d(0.48, 0.6, 0.64), Vector3d(-0.36, 0.8, -0.48), Vector3d(0.8, -0.36, -0.48)}) {
    double nearest = HUGE_VAL;
    bool from_behind = false;
    cast(p, along, [&](double distance, int f) {
      if (distance < nearest) nearest = distance, from_behind = face(f).normal.dot(along) > 0;
    });
    inside += from_behind;
  }
  return inside >= 2;
}

}  // namespace tandem::mbd
