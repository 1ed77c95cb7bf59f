#include "particles/geometry/smooth_patches.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace tandem::particles {
namespace {

using Index = std::uint32_t;

struct CellKey {
  std::int64_t x, y, z;
  bool operator==(const CellKey&) const = default;
};
struct CellHash {
  std::size_t operator()(const CellKey& k) const {
    return static_cast<std::size_t>(k.x) * 0x9e3779b97f4a7c15u ^
           static_cast<std::size_t>(k.y) * 0xc2b2ae3d27d4eb4fu ^
           static_cast<std::size_t>(k.z) * 0x165667b19e3779f9u;
  }
};

// First vertex at the position of each vertex (vertices). Positions are equal within the rounding of single
// precision, in which STL files are written.
std::vector<Index> welded(const std::vector<Vec3d>& vertices) {
  double size = 0;
  for (const Vec3d& v : vertices) size = std::max({size, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  const double tolerance = std::max(size * 2.5e-7, 1e-300), cell = 8 * tolerance;
  const auto at = [&](double x) { return static_cast<std::int64_t>(std::floor(x / cell)); };

  std::unordered_map<CellKey, std::vector<Index>, CellHash> kept;
  std::vector<Index> result(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3d v = vertices[i];
    Index found = static_cast<Index>(i);
    // Mostly a single cell, because the tolerance is small compared with it.
    for (std::int64_t x = at(v.x - tolerance); x <= at(v.x + tolerance); ++x) {
      for (std::int64_t y = at(v.y - tolerance); y <= at(v.y + tolerance); ++y) {
        for (std::int64_t z = at(v.z - tolerance); z <= at(v.z + tolerance); ++z) {
          const auto position = kept.find({x, y, z});
          if (position == kept.end()) continue;
          for (const Index other : position->second) {
            if (norm(vertices[other] - v) <= tolerance) found = std::min(found, other);
          }
        }
      }
    }
    result[i] = found;
    if (found == i) kept[{at(v.x), at(v.y), at(v.z)}].push_back(found);
  }
  return result;
}

struct Edge {
  Index low, high, triangle, opposite;  // welded vertices; `opposite` is the triangle's third
};

bool bends_smoothly(const std::vector<Vec3d>& vertices, const Edge& s, const Edge& t) {
  static const double least = std::cos(smooth_angle * std::numbers::pi / 180);
  const Vec3d along = normalized(vertices[s.high] - vertices[s.low]);
  const auto into = [&](const Edge& e) {
    const Vec3d d = vertices[e.opposite] - vertices[e.low];
    return normalized(d - dot(d, along) * along);
  };
  return -dot(into(s), into(t)) >= least;
}

Index root(std::vector<Index>& parent, Index i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

std::vector<Index> smooth_patches(const TriangleMesh& mesh) {
  const std::vector<Index> vertex = welded(mesh.vertices);
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = vertex[mesh.triangles[t][k]], b = vertex[mesh.triangles[t][(k + 1) % 3]];
      edges.push_back(
          {std::min(a, b), std::max(a, b), static_cast<Index>(t), vertex[mesh.triangles[t][(k + 2) % 3]]});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& s, const Edge& t) {
    return std::tie(s.low, s.high, s.triangle) < std::tie(t.low, t.high, t.triangle);
  });

  std::vector<Index> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    const auto same = [&](const Edge& e) { return e.low == edges[first].low && e.high == edges[first].high; };
    while (last < edges.size() && same(edges[last])) ++last;
    // Where more than two triangles share an edge (a rib on a plate), each pair is judged by itself.
    for (std::size_t s = first; s < last; ++s) {
      for (std::size_t t = s + 1; t < last; ++t) {
        const Index a = root(parent, edges[s].triangle), b = root(parent, edges[t].triangle);
        if (a != b && bends_smoothly(mesh.vertices, edges[s], edges[t]))
          parent[std::max(a, b)] = std::min(a, b);
      }
    }
  }

  std::vector<Index> patch(mesh.triangles.size());
  Index patches = 0;
  for (Index t = 0; t < patch.size(); ++t) {
    const Index r = root(parent, t);  // the lowest triangle of the patch
    patch[t] = r == t ? patches++ : patch[r];
  }
  return patch;
}

}  // namespace tandem::particles
