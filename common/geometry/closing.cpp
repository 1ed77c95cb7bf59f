#include "common/geometry/closing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "common/geometry/mass_properties.hpp"

namespace tandem {
namespace closing {
namespace {

// The parts of a set of numbers that were joined.
class Groups {
 public:
  explicit Groups(std::size_t n) : root_(n) { std::iota(root_.begin(), root_.end(), 0u); }
  std::uint32_t of(std::uint32_t k) {
    while (root_[k] != k) k = root_[k] = root_[root_[k]];
    return k;
  }
  void join(std::uint32_t a, std::uint32_t b) { root_[std::max(of(a), of(b))] = std::min(of(a), of(b)); }

 private:
  std::vector<std::uint32_t> root_;
};

// Corners nearer than the tolerance become the first of them; triangles that lose a corner go.
TriangleMesh welded(const TriangleMesh& mesh, double tolerance) {
  const std::vector<Vec3d>& v = mesh.vertices;
  std::vector<std::uint32_t> along_x(v.size());
  std::iota(along_x.begin(), along_x.end(), 0u);
  std::ranges::sort(along_x, {}, [&](std::uint32_t k) { return std::pair(v[k].x, k); });
  Groups groups(v.size());
  for (std::size_t i = 0; i < along_x.size(); ++i)
    for (std::size_t k = i + 1; k < along_x.size() && v[along_x[k]].x - v[along_x[i]].x <= tolerance; ++k)
      if (norm2(v[along_x[k]] - v[along_x[i]]) <= tolerance * tolerance) groups.join(along_x[i], along_x[k]);
  TriangleMesh joined;
  std::vector<std::uint32_t> number(v.size());
  for (std::uint32_t k = 0; k < v.size(); ++k) {
    if (groups.of(k) == k) {
      number[k] = static_cast<std::uint32_t>(joined.vertices.size());
      joined.vertices.push_back(v[k]);
    } else {
      number[k] = number[groups.of(k)];
    }
  }
  for (const auto& t : mesh.triangles) {
    const std::array<std::uint32_t, 3> of{number[t[0]], number[t[1]], number[t[2]]};
    if (of[0] != of[1] && of[1] != of[2] && of[2] != of[0]) joined.triangles.push_back(of);
  }
  return joined;
}

struct Edge {
  std::uint32_t from = 0, to = 0;
  bool of_flipped = false;  // it belongs to an even number of triangles
};

// Edges that triangles have more often in one direction than in the other, as often as that.
std::vector<Edge> boundary_of(const TriangleMesh& mesh) {
  struct Use {
    int balance = 0, triangles = 0;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Use> uses;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      Use& use = uses[std::minmax(a, b)];
      use.balance += a < b ? 1 : -1;
      ++use.triangles;
    }
  std::vector<Edge> edges;
  for (const auto& [edge, use] : uses)
    for (int n = 0; n < std::abs(use.balance); ++n) {
      const auto [low, high] = edge;
      edges.push_back({use.balance > 0 ? low : high, use.balance > 0 ? high : low, use.triangles % 2 == 0});
    }
  return edges;
}

}  // namespace
}  // namespace closing

Openings openings_of(const TriangleMesh& mesh, const std::function<bool(Vec3d)>& counts) {
  const TriangleMesh joined = closing::welded(mesh, 0);
  const std::vector<Vec3d>& v = joined.vertices;
  const std::vector<closing::Edge> edges = closing::boundary_of(joined);
  closing::Groups groups(v.size());
  for (const closing::Edge& e : edges) groups.join(e.from, e.to);
  struct Rim {
    Vec3d twice_area;
    bool counts = false, of_flipped = true;
  };
  std::map<std::uint32_t, Rim> rims;  // connected edges
  for (const closing::Edge& e : edges) {
    const std::uint32_t group = groups.of(e.from);
    Rim& rim = rims[group];
    rim.twice_area += cross(v[e.from] - v[group], v[e.to] - v[group]);
    rim.counts = rim.counts || counts(v[e.from]) || counts(v[e.to]);
    rim.of_flipped = rim.of_flipped && e.of_flipped;
  }
  Openings openings;
  for (const auto& [group, rim] : rims) {
    if (!rim.counts) continue;
    const double width = std::sqrt(0.5 * norm(rim.twice_area));
    if (rim.of_flipped)
      openings.flipped = v[group];
    else if (!openings.widest || width > openings.widest->width)
      openings.widest = {width, v[group]};
  }
  return openings;
}

Closing closing_of(const TriangleMesh& mesh, double tolerance, double width) {
  Closing result;
  result.mesh = closing::welded(mesh, tolerance);
  const Openings openings = openings_of(result.mesh, [](Vec3d) { return true; });
  if (!openings.widest && !openings.flipped) {
    if (why_not_solid(result.mesh).empty()) result.closure = Closure::solid;
    return result;
  }
  result.width = openings.widest ? openings.widest->width : 0;
  if (result.width >= width) return result;
  if (openings.flipped) {
    result.closure = Closure::flipped;
    result.why = "its triangles do not all wind the same way";
  } else if (result.width <= 4 * tolerance) {
    result.closure = Closure::solid;
  } else {
    result.closure = Closure::slit;
    result.why = "it has openings";
  }
  return result;
}

}  // namespace tandem
