#include "common/geometry/coarse_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "common/geometry/edge_collapse.hpp"
#include "common/geometry/triangle_tree.hpp"

namespace tandem {
namespace {

// One vertex for all that are at most `tolerance` [m] apart, so that triangles that join know of each other.
// Without triangles that have no area then.
TriangleMesh welded(const TriangleMesh& mesh, double tolerance) {
  using Cell = std::array<double, 3>;
  const auto cell_of = [&](Vec3d x) {
    return Cell{std::floor(x.x / (8 * tolerance)), std::floor(x.y / (8 * tolerance)),
                std::floor(x.z / (8 * tolerance))};
  };
  TriangleMesh all;
  std::multimap<Cell, std::uint32_t> known;  // vertices of `all`
  const auto number_of = [&](Vec3d v) {
    const Cell low = cell_of(v - Vec3d{tolerance, tolerance, tolerance}),
               high = cell_of(v + Vec3d{tolerance, tolerance, tolerance});
    for (double x = low[0]; x <= high[0]; ++x)
      for (double y = low[1]; y <= high[1]; ++y)
        for (double z = low[2]; z <= high[2]; ++z)
          for (auto [at, end] = known.equal_range({x, y, z}); at != end; ++at)
            if (norm(all.vertices[at->second] - v) <= tolerance) return at->second;
    const auto number = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.push_back(v);
    known.emplace(cell_of(v), number);
    return number;
  };
  std::vector<std::uint32_t> number;
  for (const Vec3d& v : mesh.vertices) number.push_back(number_of(v));
  for (const auto& [a, b, c] : mesh.triangles)
    if (number[a] != number[b] && number[b] != number[c] && number[c] != number[a])
      all.triangles.push_back({number[a], number[b], number[c]});
  return all;
}

// A point of the surface that is given.
struct Sample {
  Vec3d x;           // [m]
  double limit = 0;  // distance that is allowed [m]
};

class Coarsening {
 public:
  Coarsening(const TriangleMesh& mesh, double deviation)
      : given_(mesh), tree_(mesh), patch_(mesh), limit_(mesh.vertices.size(), deviation) {
    limit_at_open_edges(deviation / 5);
    limit_at_facing_surfaces();
    take_samples(deviation);
  }

  void run() {
    for (std::uint32_t v = 0; v < given_.vertices.size(); ++v)
      for (const std::uint32_t w : patch_.neighbours(v))
        if (v < w) consider(v, w);
    while (!queue_.empty()) {
      const Candidate next = queue_.top();
      queue_.pop();
      if (next.version != patch_.version(next.v) + patch_.version(next.w)) continue;
      const auto collapse = patch_.collapse_of(next.v, next.w);
      if (!collapse || !patch_.keeps_shape(*collapse) || !stays_near(*collapse)) continue;
      apply(*collapse);
    }
  }

  CoarseMesh result() const {
    CoarseMesh coarse{patch_.mesh(), 0};
    const TriangleTree tree(coarse.mesh);
    for (const Sample& s : samples_)
      coarse.deviation = std::max(coarse.deviation, tree.nearest(s.x, 1e300)->distance);
    for (const auto& t : coarse.mesh.triangles) {
      constexpr int parts = 4;
      const Vec3d a = coarse.mesh.vertices[t[0]], b = coarse.mesh.vertices[t[1]] - a,
                  c = coarse.mesh.vertices[t[2]] - a;
      for (int i = 0; i <= parts; ++i)
        for (int j = 0; i + j <= parts; ++j) {
          const Vec3d x = a + (1.0 * i / parts) * b + (1.0 * j / parts) * c;
          coarse.deviation = std::max(coarse.deviation, tree_.nearest(x, 1e300)->distance);
        }
    }
    return coarse;
  }

 private:
  struct Candidate {
    double cost = 0;
    std::uint32_t v = 0, w = 0;
    std::uint64_t version = 0;
    // The queue begins with the largest one.
    friend bool operator<(const Candidate& a, const Candidate& b) {
      return std::tuple(a.cost, a.v, a.w) > std::tuple(b.cost, b.v, b.w);
    }
  };

  void limit_at_open_edges(double limit) {
    for (std::uint32_t v = 0; v < given_.vertices.size(); ++v)
      if (patch_.is_at_open_edge(v)) limit_[v] = std::min(limit_[v], limit);
  }

  // The other side of a sheet, or of a gap: a triangle that faces the other way and does not end here.
  void limit_at_facing_surfaces() {
    for (std::uint32_t v = 0; v < given_.vertices.size(); ++v) {
      const Vec3d normal = patch_.normal_at(v);
      const auto facing = tree_.nearest(given_.vertices[v], 4 * limit_[v], [&](std::uint32_t t) {
        const auto& corners = given_.triangles[t];
        return std::ranges::find(corners, v) == corners.end() &&
               dot(patch_.area_vector(t), normal) < -0.2 * norm(patch_.area_vector(t)) * norm(normal);
      });
      if (facing) limit_[v] = std::min(limit_[v], facing->distance / 4);
    }
  }

  // Vertices, and points of edges at which the surface bends: in between it is flat.
  void take_samples(double deviation) {
    of_triangle_.resize(given_.triangles.size());
    const auto add = [this](std::uint32_t triangle, Vec3d x, double limit) {
      of_triangle_[triangle].push_back(static_cast<std::uint32_t>(samples_.size()));
      samples_.push_back({x, limit});
    };
    for (std::uint32_t v = 0; v < given_.vertices.size(); ++v)
      if (!patch_.triangles_of(v).empty()) add(patch_.triangles_of(v).front(), given_.vertices[v], limit_[v]);
    for (std::uint32_t v = 0; v < given_.vertices.size(); ++v)
      for (const std::uint32_t w : patch_.neighbours(v)) {
        if (w < v || patch_.is_flat_at(v, w)) continue;
        const Vec3d from = given_.vertices[v], edge = given_.vertices[w] - from;
        const int parts = static_cast<int>(std::clamp(norm(edge) / (8 * deviation), 2.0, 16.0));
        for (int k = 1; k < parts; ++k)
          add(patch_.triangles_between(v, w).front(), from + (1.0 * k / parts) * edge,
              std::min(limit_[v], limit_[w]));
      }
  }

  void consider(std::uint32_t v, std::uint32_t w) {
    if (const auto collapse = patch_.collapse_of(v, w))
      queue_.push({collapse->cost, v, w, patch_.version(v) + patch_.version(w)});
  }

  bool stays_near(const EdgeCollapse& c) const {
    const double limit = std::min(limit_[c.kept], limit_[c.removed]);
    const auto is_near = [&](Vec3d x) { return tree_.is_within(x, limit); };
    if (!is_near(c.at)) return false;
    for (const std::uint32_t triangle : c.before)
      for (const std::uint32_t s : of_triangle_[triangle])
        if (nearest_of(c, samples_[s].x).second > samples_[s].limit) return false;
    std::size_t samples = 0;
    for (const std::uint32_t triangle : c.before) samples += of_triangle_[triangle].size();
    // The finer the surface that a triangle stands for, the closer are the points to look at.
    const int parts = std::min(16, 2 + static_cast<int>(std::sqrt(static_cast<double>(samples))));
    for (const Triangle3& t : c.after) {
      for (int k = 1; k < parts; ++k)
        if (!is_near(t.a + (1.0 * k / parts) * (t.b - t.a))) return false;
      const int across = std::max(3, parts / 2);
      for (int i = 1; i + 1 < across; ++i)
        for (int j = 1; i + j < across; ++j)
          if (!is_near(t.a + (1.0 * i / across) * (t.b - t.a) + (1.0 * j / across) * (t.c - t.a)))
            return false;
    }
    return true;
  }

  // Which of the triangles after the collapse is nearest, and how far it is.
  static std::pair<std::size_t, double> nearest_of(const EdgeCollapse& c, Vec3d x) {
    std::pair<std::size_t, double> found{0, 1e300};
    for (std::size_t k = 0; k < c.after.size(); ++k) {
      const double distance = norm(nearest_point(c.after[k].a, c.after[k].b, c.after[k].c, x) - x);
      if (distance < found.second) found = {k, distance};
    }
    return found;
  }

  void apply(const EdgeCollapse& c) {
    std::vector<std::uint32_t> to_place;
    for (const std::uint32_t triangle : c.before) {
      std::vector<std::uint32_t>& own = of_triangle_[triangle];
      to_place.insert(to_place.end(), own.begin(), own.end());
      own.clear();
    }
    for (const std::uint32_t s : to_place)
      of_triangle_[c.left[nearest_of(c, samples_[s].x).first]].push_back(s);
    limit_[c.kept] = std::min(limit_[c.kept], limit_[c.removed]);
    patch_.apply(c);
    const std::vector<std::uint32_t> around = patch_.neighbours(c.kept);
    for (const std::uint32_t v : around) {
      consider(std::min(v, c.kept), std::max(v, c.kept));
      for (const std::uint32_t w : patch_.neighbours(v))
        if (v < w && std::ranges::binary_search(around, w)) consider(v, w);
    }
  }

  const TriangleMesh& given_;
  TriangleTree tree_;
  CollapsibleMesh patch_;
  std::vector<double> limit_;  // (vertices) [m]
  std::vector<Sample> samples_;
  std::vector<std::vector<std::uint32_t>> of_triangle_;  // samples that each triangle stands for
  std::priority_queue<Candidate> queue_;
};

}  // namespace

CoarseMesh coarsened(const TriangleMesh& mesh, double deviation) {
  if (!degenerate_triangles(mesh).empty()) return {mesh, 0};
  const TriangleMesh joined = welded(mesh, 1e-5 * deviation);
  // Collapses look at points of the surfaces; in between they may be farther apart, as rough surfaces are.
  double limit = 0.95 * deviation;
  for (int tries = 0; tries < 4; ++tries) {
    Coarsening coarsening(joined, limit);
    coarsening.run();
    CoarseMesh coarse = coarsening.result();
    if (coarse.mesh.triangles.size() == mesh.triangles.size()) break;
    if (coarse.deviation <= deviation) return coarse;
    limit *= 0.95 * deviation / coarse.deviation;
  }
  return {mesh, 0};
}

}  // namespace tandem
