#include "common/geometry/edge_collapse.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/math/rotation.hpp"

namespace tandem {
namespace {

// Height over the longest side.
double narrowness(Vec3d area_vector, Vec3d a, Vec3d b, Vec3d c) {
  return norm(area_vector) / std::max({norm2(b - a), norm2(c - b), norm2(a - c)});
}

// Minimum of a sum of squares (n y - h)^2 over places y, near the origin where several do as well.
struct Quadric {
  Mat3d A{};
  Vec3d b;
  double c = 0;

  void add(Vec3d n, double h, double weight) {
    for (int i = 0; i < 3; ++i) A.row[i] += weight * n[i] * n;
    b += weight * h * n;
    c += weight * h * h;
  }
  double trace() const { return A.row[0].x + A.row[1].y + A.row[2].z; }
  double at(Vec3d y) const { return std::max(0.0, dot(y, A * y) - 2 * dot(b, y) + c); }
};

Vec3d solved(const Mat3d& M, Vec3d right) {
  const Vec3d x = M.row[0], y = M.row[1], z = M.row[2], yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
  return (1 / dot(x, yz)) * (right.x * yz + right.y * zx + right.z * xy);
}

}  // namespace

CollapsibleMesh::CollapsibleMesh(const TriangleMesh& mesh)
    : position_(mesh.vertices),
      triangle_(mesh.triangles),
      removed_(mesh.triangles.size(), false),
      of_vertex_(mesh.vertices.size()),
      open_(mesh.vertices.size(), false),
      fixed_(mesh.vertices.size(), false),
      version_(mesh.vertices.size(), 0) {
  for (std::uint32_t t = 0; t < triangle_.size(); ++t)
    for (const std::uint32_t v : triangle_[t]) of_vertex_[v].push_back(t);
  for (std::uint32_t v = 0; v < position_.size(); ++v) {
    for (const std::uint32_t w : neighbours(v))
      if (triangles_between(v, w).size() == 1) open_[v] = true;
    fixed_[v] = !is_manifold_at(v);
  }
}

bool CollapsibleMesh::has(std::uint32_t triangle, std::uint32_t v) const {
  return std::ranges::find(triangle_[triangle], v) != triangle_[triangle].end();
}

std::vector<std::uint32_t> CollapsibleMesh::neighbours(std::uint32_t v) const {
  std::vector<std::uint32_t> all;
  for (const std::uint32_t t : of_vertex_[v])
    for (const std::uint32_t w : triangle_[t])
      if (w != v) all.push_back(w);
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  return all;
}

std::vector<std::uint32_t> CollapsibleMesh::triangles_between(std::uint32_t v, std::uint32_t w) const {
  std::vector<std::uint32_t> all;
  for (const std::uint32_t t : of_vertex_[v])
    if (has(t, w)) all.push_back(t);
  return all;
}

Vec3d CollapsibleMesh::area_vector(std::uint32_t triangle) const {
  const auto& t = triangle_[triangle];
  return cross(position_[t[1]] - position_[t[0]], position_[t[2]] - position_[t[0]]);
}

Vec3d CollapsibleMesh::normal_at(std::uint32_t v) const {
  Vec3d sum;
  for (const std::uint32_t t : of_vertex_[v]) sum += area_vector(t);
  return sum;
}

bool CollapsibleMesh::is_flat_at(std::uint32_t v, std::uint32_t w) const {
  const std::vector<std::uint32_t> both = triangles_between(v, w);
  if (both.size() != 2) return false;
  const Vec3d n = area_vector(both[0]), m = area_vector(both[1]);
  return dot(n, m) > 0 && norm(cross(n, m)) < 1e-6 * norm(n) * norm(m);
}

// Do the triangles at the vertex join to one fan, each edge with one or two of them that are oriented alike?
bool CollapsibleMesh::is_manifold_at(std::uint32_t v) const {
  std::vector<std::uint32_t> from, to;  // along the side of each triangle that is opposite v
  for (const std::uint32_t t : of_vertex_[v]) {
    const auto& corners = triangle_[t];
    const auto k = static_cast<std::size_t>(std::ranges::find(corners, v) - corners.begin());
    from.push_back(corners[(k + 1) % 3]);
    to.push_back(corners[(k + 2) % 3]);
  }
  const auto index = [](const std::vector<std::uint32_t>& list, std::uint32_t w) {
    return static_cast<std::size_t>(std::ranges::find(list, w) - list.begin());
  };
  if (from.empty()) return false;
  for (std::size_t k = 0; k < from.size(); ++k)
    if (std::ranges::count(from, from[k]) > 1 || std::ranges::count(to, to[k]) > 1) return false;
  std::size_t begin = 0;  // of an open fan, the triangle at its first edge
  for (std::size_t k = 0; k < from.size(); ++k)
    if (index(to, from[k]) == to.size()) begin = k;
  std::size_t count = 1;
  for (std::size_t k = index(from, to[begin]); k < from.size() && k != begin; k = index(from, to[k])) ++count;
  return count == from.size();
}

bool CollapsibleMesh::keeps_topology(std::uint32_t v, std::uint32_t w) const {
  if (fixed_[v] || fixed_[w]) return false;
  const std::vector<std::uint32_t> of_v = neighbours(v), of_w = neighbours(w);
  std::vector<std::uint32_t> common;
  std::ranges::set_intersection(of_v, of_w, std::back_inserter(common));
  const std::size_t both = triangles_between(v, w).size();
  if (common.size() != both || both == 0) return false;
  if (open_[v] && open_[w] && both != 1) return false;
  const std::size_t around = of_v.size() + of_w.size() - common.size() - 2;
  return around >= (open_[v] || open_[w] ? 2u : 3u);
}

void CollapsibleMesh::place(EdgeCollapse& c) const {
  const Vec3d middle = 0.5 * (position_[c.kept] + position_[c.removed]);
  Quadric q;
  Vec3d area;
  double swept = 0;
  for (const std::uint32_t t : c.before) {
    const Vec3d n = area_vector(t);
    const double h = dot(n, position_[triangle_[t][0]] - middle);
    q.add(n, h, 1);
    area += n;
    swept += h;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangle_[t][k], to = triangle_[t][(k + 1) % 3];
      const bool ends_here = from == c.kept || from == c.removed || to == c.kept || to == c.removed;
      if (!ends_here || !open_[from] || !open_[to] || triangles_between(from, to).size() != 1) continue;
      const Vec3d edge = position_[to] - position_[from], outward = norm(edge) / norm(n) * cross(edge, n);
      q.add(outward, dot(outward, position_[from] - middle), 4);
    }
  }
  Mat3d M = q.A;
  constexpr double of_middle = 1e-9;  // share of the distance from the middle of the edge
  for (int i = 0; i < 3; ++i) M.row[i][i] += of_middle * q.trace();
  Vec3d y = solved(M, q.b);
  const Vec3d along = solved(M, area);
  if (const double response = dot(area, along); norm2(area) > 1e-6 * q.trace() && response > 0)
    y += (swept - dot(area, y)) / response * along;
  c.at = middle + y;
  // Of collapses that change nothing, that of the shortest edge is first.
  c.cost = q.at(y) + of_middle * q.trace() * norm2(position_[c.kept] - position_[c.removed]);
}

std::optional<EdgeCollapse> CollapsibleMesh::collapse_of(std::uint32_t v, std::uint32_t w) const {
  if (!keeps_topology(v, w)) return std::nullopt;
  EdgeCollapse c;
  c.kept = v;
  c.removed = w;
  std::ranges::set_union(of_vertex_[v], of_vertex_[w], std::back_inserter(c.before));
  place(c);
  for (const std::uint32_t t : c.before) {
    const bool has_v = has(t, v), has_w = has(t, w);
    if (has_v && has_w) continue;
    const auto& corners = triangle_[t];
    const auto k = static_cast<std::size_t>(std::ranges::find(corners, has_v ? v : w) - corners.begin());
    c.left.push_back(t);
    c.after.push_back({c.at, position_[corners[(k + 1) % 3]], position_[corners[(k + 2) % 3]]});
  }
  return c;
}

bool CollapsibleMesh::keeps_shape(const EdgeCollapse& c) const {
  double narrowest = 1;
  for (const std::uint32_t t : c.before) {
    const auto& k = triangle_[t];
    narrowest =
        std::min(narrowest, narrowness(area_vector(t), position_[k[0]], position_[k[1]], position_[k[2]]));
  }
  constexpr double wide = 0.05, needle = 0.01;
  const double bound = std::min(narrowest, std::clamp(0.8 * narrowest, needle, wide));
  for (std::size_t k = 0; k < c.left.size(); ++k) {
    const Triangle3& t = c.after[k];
    const Vec3d n = cross(t.b - t.a, t.c - t.a), before = area_vector(c.left[k]);
    if (narrowness(n, t.a, t.b, t.c) < bound || dot(n, before) < 0.2 * norm(n) * norm(before)) return false;
  }
  return true;
}

void CollapsibleMesh::apply(const EdgeCollapse& c) {
  position_[c.kept] = c.at;
  for (const std::uint32_t t : c.before) {
    if (std::ranges::find(c.left, t) == c.left.end()) {
      removed_[t] = true;
      for (const std::uint32_t v : triangle_[t]) std::erase(of_vertex_[v], t);
    } else {
      std::ranges::replace(triangle_[t], c.removed, c.kept);
    }
  }
  of_vertex_[c.kept] = c.left;
  of_vertex_[c.removed].clear();
  open_[c.kept] = open_[c.kept] || open_[c.removed];
  ++version_[c.kept];
  ++version_[c.removed];
}

TriangleMesh CollapsibleMesh::mesh() const {
  TriangleMesh left;
  std::vector<std::uint32_t> number(position_.size());
  for (std::uint32_t v = 0; v < position_.size(); ++v) {
    if (of_vertex_[v].empty()) continue;
    number[v] = static_cast<std::uint32_t>(left.vertices.size());
    left.vertices.push_back(position_[v]);
  }
  for (std::uint32_t t = 0; t < triangle_.size(); ++t) {
    const auto& k = triangle_[t];
    if (!removed_[t]) left.triangles.push_back({number[k[0]], number[k[1]], number[k[2]]});
  }
  return left;
}

}  // namespace tandem
