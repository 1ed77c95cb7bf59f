#include "coordinator/mesh_import/mesh_facts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

namespace tandem::launch {
namespace {

using Vertex = std::uint32_t;

// An edge in the direction of its triangle.
struct Edge {
  Vertex from, to;
};

// Calls visit(lower, higher, forward, backward) for each edge between two vertices, with the numbers of
// triangles that traverse it from the lower to the higher vertex and in the opposite direction.
template <class Visit>
void for_each_edge(const TriangleMesh& mesh, const Visit& visit) {
  // index in `far` of the first edge of each lower vertex
  std::vector<std::size_t> first(mesh.vertices.size() + 1, 0);
  const auto each_side = [&](const auto& act) {
    for (const auto& t : mesh.triangles)
      for (int i = 0; i < 3; ++i) act(t[i], t[(i + 1) % 3]);
  };
  each_side([&](Vertex a, Vertex b) { ++first[std::min(a, b) + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  // Twice the higher vertex, plus 1 where the triangle traverses the edge from the higher to the lower
  // vertex.
  std::vector<std::uint64_t> far(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  each_side([&](Vertex a, Vertex b) {
    far[next[std::min(a, b)]++] = 2 * std::uint64_t{std::max(a, b)} + (a > b ? 1 : 0);
  });
  for (std::size_t lower = 0; lower + 1 < first.size(); ++lower) {
    const auto begin = far.begin() + static_cast<std::ptrdiff_t>(first[lower]);
    const auto end = far.begin() + static_cast<std::ptrdiff_t>(first[lower + 1]);
    std::sort(begin, end);
    for (auto at = begin; at != end;) {
      const std::uint64_t higher = *at / 2;
      std::size_t uses[2] = {0, 0};
      for (; at != end && *at / 2 == higher; ++at) ++uses[*at % 2];
      visit(static_cast<Vertex>(lower), static_cast<Vertex>(higher), uses[0], uses[1]);
    }
  }
}

// Joins ends of open edges that are nearly at the same place (union-find with path halving, on a grid of
// cells as wide as the distance).
class NearCorners {
 public:
  NearCorners(const TriangleMesh& mesh, const MeshFacts& facts, const std::vector<Edge>& open)
      : mesh_(mesh), corner_(facts.min), distance_(1e-5 * facts.diagonal()) {
    for (const Edge& edge : open)
      for (const Vertex v : {edge.from, edge.to})
        if (parent_.try_emplace(v, v).second) grid_.emplace(key(cell(v, 0), cell(v, 1), cell(v, 2)), v);
    // The ends of an edge that is shorter than the distance stay separate.
    for (const Edge& edge : open)
      if (gap(edge.from, edge.to) <= distance_) apart_.insert({edge.from, edge.to});
    for (const auto& [v, parent] : std::map(parent_.begin(), parent_.end())) join_neighbours(v);
  }

  Vertex root(Vertex v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  double gap(Vertex a, Vertex b) const { return norm(mesh_.vertices[a] - mesh_.vertices[b]); }

 private:
  // At most 1e5 cells along an axis and one at each end: 20 bits are enough.
  std::int64_t cell(Vertex v, int axis) const {
    return static_cast<std::int64_t>((mesh_.vertices[v][axis] - corner_[axis]) / distance_) + 1;
  }
  static std::int64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return (x << 40) | (y << 20) | z;
  }

  void join_neighbours(Vertex v) {
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto [begin, end] = grid_.equal_range(key(cell(v, 0) + x, cell(v, 1) + y, cell(v, 2) + z));
          for (auto at = begin; at != end; ++at)
            if (gap(at->second, v) <= distance_ && !apart_.contains(v) && !apart_.contains(at->second))
              parent_[root(at->second)] = root(v);
        }
  }

  const TriangleMesh& mesh_;
  Vec3d corner_;
  double distance_;
  std::unordered_map<Vertex, Vertex> parent_;
  std::unordered_multimap<std::int64_t, Vertex> grid_;
  std::set<Vertex> apart_;
};

// Removes from `open` the edges that are closed once nearly equal corners are joined, and counts them. The
// remaining edges connect joined corners.
void join_corners(const TriangleMesh& mesh, std::vector<Edge>& open, MeshFacts& facts) {
  NearCorners corners(mesh, facts, open);
  const auto ends = [&](const Edge& edge) {
    return std::minmax({corners.root(edge.from), corners.root(edge.to)});
  };
  std::map<std::pair<Vertex, Vertex>, int> uses;
  for (const Edge& edge : open) ++uses[ends(edge)];
  std::vector<Edge> left;
  for (const Edge& edge : open) {
    if (uses[ends(edge)] == 1) {
      left.push_back({corners.root(edge.from), corners.root(edge.to)});
      continue;
    }
    ++facts.unjoined_edges;
    for (const Vertex v : {edge.from, edge.to})
      if (const double gap = corners.gap(v, corners.root(v)); gap > facts.widest_gap) {
        facts.widest_gap = gap;
        facts.unjoined_at = mesh.vertices[v];
      }
  }
  open = std::move(left);
}

Opening opening_of(const TriangleMesh& mesh, const std::vector<Vertex>& loop) {
  Opening opening;
  opening.at = mesh.vertices[loop.front()];
  opening.edges = loop.size();
  Vec3d area, min = opening.at, max = opening.at;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3d a = mesh.vertices[loop[i]], b = mesh.vertices[loop[(i + 1) % loop.size()]];
    opening.length += norm(b - a);
    area += 0.5 * cross(a - opening.at, b - opening.at);
    for (int k = 0; k < 3; ++k) {
      min[k] = std::min(min[k], a[k]);
      max[k] = std::max(max[k], a[k]);
    }
  }
  opening.extent = norm(max - min);
  opening.width = 4 * norm(area) / opening.length;
  return opening;
}

// Follows open edges. Where a path returns to one of its corners a loop is closed and removed from the path,
// so that two openings that share a corner are counted as two.
std::vector<Opening> openings_of(const TriangleMesh& mesh, const std::vector<Edge>& open) {
  std::unordered_map<Vertex, std::vector<std::size_t>> at;  // open edges at each corner
  for (std::size_t e = 0; e < open.size(); ++e) {
    at[open[e].from].push_back(e);
    at[open[e].to].push_back(e);
  }
  std::vector<bool> used(open.size());
  const auto next_edge = [&](Vertex v) {
    std::vector<std::size_t>& edges = at[v];
    while (!edges.empty() && used[edges.back()]) edges.pop_back();
    return edges.empty() ? open.size() : edges.back();
  };
  std::vector<Opening> openings;
  std::unordered_map<Vertex, std::size_t> place;  // in the path
  for (const Edge& first : open) {
    std::vector<Vertex> path{first.from};
    place = {{first.from, 0}};
    for (std::size_t e = next_edge(first.from); e < open.size(); e = next_edge(path.back())) {
      used[e] = true;
      const Vertex v = open[e].from == path.back() ? open[e].to : open[e].from;
      const auto [entry, is_new] = place.try_emplace(v, path.size());
      path.push_back(v);
      if (is_new) continue;
      const std::vector<Vertex> loop(path.begin() + static_cast<std::ptrdiff_t>(entry->second),
                                     path.end() - 1);
      openings.push_back(opening_of(mesh, loop));
      path.resize(entry->second + 1);
      for (std::size_t i = 1; i < loop.size(); ++i) place.erase(loop[i]);
    }
    // Edges of three or more triangles can leave a path with two ends.
    if (path.size() == 1) continue;
    openings.push_back(opening_of(mesh, path));
    openings.back().edges = path.size() - 1;
  }
  std::stable_sort(openings.begin(), openings.end(),
                   [](const Opening& a, const Opening& b) { return a.width > b.width; });
  return openings;
}

}  // namespace

MeshFacts facts_of(const TriangleMesh& mesh) {
  MeshFacts facts;
  facts.triangles = mesh.triangles.size();
  facts.min = facts.max = mesh.vertices.front();
  for (const Vec3d& p : mesh.vertices)
    for (int k = 0; k < 3; ++k) {
      facts.min[k] = std::min(facts.min[k], p[k]);
      facts.max[k] = std::max(facts.max[k], p[k]);
    }
  const Vec3d centre = 0.5 * (facts.min + facts.max);
  double volume = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d a = mesh.vertices[i] - centre, b = mesh.vertices[j] - centre, c = mesh.vertices[k] - centre;
    facts.area += 0.5 * norm(cross(b - a, c - a));
    volume += dot(a, cross(b, c)) / 6;
  }

  std::vector<Edge> open;
  for_each_edge(mesh, [&](Vertex lower, Vertex higher, std::size_t forward, std::size_t backward) {
    if (forward + backward > 2) ++facts.non_manifold_edges;
    if (forward + backward == 2 && forward != 1) ++facts.inverted_edges;
    if (forward + backward == 1) open.push_back(forward == 1 ? Edge{lower, higher} : Edge{higher, lower});
  });
  if (!open.empty()) join_corners(mesh, open, facts);
  facts.open_edges = open.size();
  facts.openings = openings_of(mesh, open);
  if (open.empty() && facts.inverted_edges == 0 && facts.non_manifold_edges == 0) facts.volume = volume;
  return facts;
}

}  // namespace tandem::launch
