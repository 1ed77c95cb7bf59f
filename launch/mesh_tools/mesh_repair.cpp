#include "launch/mesh_tools/mesh_repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/geometry/triangle_tree.hpp"
#include "coordinator/mesh_import/mesh_facts.hpp"
#include "launch/mesh_tools/closed_parts.hpp"
#include "launch/mesh_tools/fill_openings.hpp"
#include "launch/mesh_tools/mesh_edges.hpp"

namespace tandem::launch {
namespace mesh_repair {

class Repair {
 public:
  Repair(const TriangleMesh& mesh, const RepairOptions& options) : mesh_(mesh) {
    diagonal_ = facts_of(mesh).diagonal();
    tolerance_ = options.weld.value_or(1e-5 * diagonal_);
    widest_ = options.fill.value_or(1e300);
  }

  RepairedMesh run() {
    weld();
    drop_empty_and_double();
    divide_edges();
    drop_empty_and_double();
    wind();
    fill_openings();
    point_outwards();
    return {std::move(mesh_), std::move(done_), std::move(unclear_), 0};
  }

 private:
  void say(std::size_t number, const std::string& what) {
    if (number > 0) done_.push_back(fmt::format("{} {}", number, what));
  }

  // One vertex for all within the tolerance of it, in the order of the file.
  void weld() {
    using Cell = std::array<double, 3>;
    const double width = 4 * tolerance_;
    std::multimap<Cell, Vertex> cells;
    std::vector<Vertex> number;
    TriangleMesh all;
    const auto cell_of = [&](Vec3d x) {
      return Cell{std::floor(x.x / width), std::floor(x.y / width), std::floor(x.z / width)};
    };
    const auto number_of = [&](Vec3d v) {
      const Vec3d margin{tolerance_, tolerance_, tolerance_};
      const Cell low = cell_of(v - margin), high = cell_of(v + margin);
      for (double x = low[0]; x <= high[0]; ++x)
        for (double y = low[1]; y <= high[1]; ++y)
          for (double z = low[2]; z <= high[2]; ++z)
            for (auto [at, end] = cells.equal_range({x, y, z}); at != end; ++at)
              if (norm(all.vertices[at->second] - v) <= tolerance_) return at->second;
      all.vertices.push_back(v);
      cells.emplace(cell_of(v), static_cast<Vertex>(all.vertices.size() - 1));
      return static_cast<Vertex>(all.vertices.size() - 1);
    };
    for (const Vec3d& v : mesh_.vertices) number.push_back(number_of(v));
    for (const auto& [a, b, c] : mesh_.triangles) all.triangles.push_back({number[a], number[b], number[c]});
    say(mesh_.vertices.size() - all.vertices.size(),
        fmt::format("corners joined with others within {:.3g} m", tolerance_));
    mesh_ = std::move(all);
  }

  // Opposite triangles between two solids are an inner wall, where both go: each edge belongs to an even
  // number of triangles. Elsewhere one of two stays, so that the surface does not open.
  void drop_empty_and_double() {
    const std::vector<std::size_t> degenerate = degenerate_triangles(mesh_);
    std::vector<Corners> with_area;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      if (a != b && b != c && c != a && !std::ranges::binary_search(degenerate, t))
        with_area.push_back(mesh_.triangles[t]);
    }
    say(mesh_.triangles.size() - with_area.size(), "triangles without area left out");
    mesh_.triangles = std::move(with_area);

    const auto at = triangles_at_edges(mesh_);
    std::map<Corners, std::size_t> known;
    std::vector<bool> stays(mesh_.triangles.size(), true);
    std::size_t doubles = 0, walls = 0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Corners& own = mesh_.triangles[t];
      Corners sorted = own;
      std::ranges::sort(sorted);
      const auto [first, is_new] = known.try_emplace(sorted, t);
      if (is_new) continue;
      stays[t] = false;
      bool is_wall = are_opposite(own, mesh_.triangles[first->second]);
      for (std::size_t i = 0; i < 3; ++i) is_wall &= at.at(edge_of(own[i], own[(i + 1) % 3])).size() % 2 == 0;
      if (is_wall) {
        stays[first->second] = false;
        known.erase(first);
        ++walls;
      } else {
        ++doubles;
      }
    }
    std::vector<Corners> kept;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      if (stays[t]) kept.push_back(mesh_.triangles[t]);
    mesh_.triangles = std::move(kept);
    say(doubles, "duplicate triangles left out");
    say(walls, "pairs of opposite triangles left out, as the wall between two solids");
  }

  static bool are_opposite(const Corners& a, const Corners& b) {
    const auto i = static_cast<std::size_t>(std::ranges::find(b, a[0]) - b.begin());
    return b[(i + 2) % 3] == a[1];
  }

  // Open edges with corners of other open edges on them: their triangle is divided there.
  void divide_edges() {
    std::size_t divided = 0;
    for (bool changed = true; changed;) {
      changed = false;
      std::vector<std::pair<Edge, std::size_t>> open;
      std::set<Vertex> ends;
      for (const auto& [edge, triangles] : triangles_at_edges(mesh_))
        if (triangles.size() == 1) {
          open.emplace_back(edge, triangles.front());
          ends.insert({edge.first, edge.second});
        }
      std::set<std::size_t> touched;
      for (const auto& [edge, t] : open) {
        const Vec3d from = mesh_.vertices[edge.first], along = mesh_.vertices[edge.second] - from;
        std::optional<std::pair<double, Vertex>> nearest;
        for (const Vertex v : ends) {
          if (v == edge.first || v == edge.second) continue;
          const double share = dot(mesh_.vertices[v] - from, along) / norm2(along);
          if (share <= 0 || share >= 1 || norm(from + share * along - mesh_.vertices[v]) > tolerance_)
            continue;
          if (!nearest || share < nearest->first) nearest = {share, v};
        }
        if (!nearest || !touched.insert(t).second) continue;
        Corners& one = mesh_.triangles[t];
        if (std::ranges::find(one, nearest->second) != one.end()) continue;
        Corners other = one;
        *std::ranges::find(one, edge.second) = nearest->second;
        *std::ranges::find(other, edge.first) = nearest->second;
        mesh_.triangles.push_back(other);
        ++divided;
        changed = true;
      }
    }
    say(divided, "triangles divided at corners on their edges");
  }

  // Each connected part winds as its first triangle does; parts join over edges of two triangles.
  void wind() {
    const auto at = triangles_at_edges(mesh_);
    part_.assign(mesh_.triangles.size(), SIZE_MAX);
    std::size_t turned = 0;
    parts_ = 0;
    for (std::size_t first = 0; first < part_.size(); ++first) {
      if (part_[first] != SIZE_MAX) continue;
      std::vector<std::size_t> open{first};
      part_[first] = parts_;
      while (!open.empty()) {
        const std::size_t t = open.back();
        open.pop_back();
        const Corners own = mesh_.triangles[t];
        for (std::size_t i = 0; i < 3; ++i) {
          const Vertex a = own[i], b = own[(i + 1) % 3];
          const auto& both = at.at(edge_of(a, b));
          if (both.size() != 2) continue;
          const std::size_t other = both[0] == t ? both[1] : both[0];
          if (part_[other] != SIZE_MAX) continue;
          Corners& next = mesh_.triangles[other];
          for (std::size_t k = 0; k < 3; ++k)
            if (next[k] == a && next[(k + 1) % 3] == b) {
              std::swap(next[1], next[2]);
              ++turned;
              break;
            }
          part_[other] = parts_;
          open.push_back(other);
        }
      }
      ++parts_;
    }
    say(turned, "triangles turned, to wind as their neighbours");
  }

  void fill_openings() {
    const FilledOpenings result = mesh_repair::fill_openings(mesh_, part_, widest_);
    if (result.filled > 0)
      done_.push_back(fmt::format("{} openings filled, the widest {:.3g} m", result.filled, result.widest));
    if (result.left > 0) done_.push_back(fmt::format("{} openings left as they are", result.left));
  }

  void point_outwards() {
    TurnedParts turned = turn_outwards(mesh_, part_);
    say(turned.outwards,
        turned.outwards == 1 ? "closed part turned outwards" : "closed parts turned outwards");
    say(turned.inwards, turned.inwards == 1 ? "cavity turned inwards" : "cavities turned inwards");
    unclear_ = std::move(turned.unclear);
  }

  TriangleMesh mesh_;
  double diagonal_ = 0, tolerance_ = 0, widest_ = 0;  // [m]
  std::vector<std::size_t> part_;                     // (triangles)
  std::size_t parts_ = 0;
  std::vector<std::string> done_, unclear_;
};

double distance_to(const TriangleMesh& from, const TriangleTree& to) {
  double largest = 0;
  const auto look = [&](Vec3d x) {
    if (const auto nearest = to.nearest(x, 1e300)) largest = std::max(largest, nearest->distance);
  };
  for (const auto& [i, j, k] : from.triangles) {
    const Vec3d a = from.vertices[i], b = from.vertices[j], c = from.vertices[k];
    for (const Vec3d x : {a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (1.0 / 3) * (a + b + c)})
      look(x);
  }
  return largest;
}

}  // namespace mesh_repair

double distance_between(const TriangleMesh& a, const TriangleMesh& b) {
  return std::max(mesh_repair::distance_to(a, TriangleTree(b)), mesh_repair::distance_to(b, TriangleTree(a)));
}

RepairedMesh repaired(const TriangleMesh& mesh, const RepairOptions& options) {
  RepairedMesh result = mesh_repair::Repair(mesh, options).run();
  if (!result.mesh.triangles.empty()) result.deviation = distance_between(mesh, result.mesh);
  return result;
}

}  // namespace tandem::launch
