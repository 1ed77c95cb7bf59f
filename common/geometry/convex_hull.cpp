#include "common/geometry/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/geometry/bounds.hpp"
namespace tandem {

namespace {

// Coordinates on the grid are below 2^39: differences fit 40 bits, the components of a normal 82 bits, and a
// volume 124 bits.
__extension__ using Wide = __int128;
using Lattice = std::array<std::int64_t, 3>;
using Normal = std::array<Wide, 3>;

Lattice minus(const Lattice& a, const Lattice& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Normal cross_of(const Lattice& a, const Lattice& b) {
  const auto product = [&](int i, int k) { return Wide{a[i]} * b[k] - Wide{a[k]} * b[i]; };
  return {product(1, 2), product(2, 0), product(0, 1)};
}
Wide dot_of(const Normal& n, const Lattice& a) {
  return n[0] * a[0] + n[1] * a[1] + n[2] * a[2];
}
Wide size_of(Wide value) {
  return value < 0 ? -value : value;
}

std::vector<Lattice> on_grid(const std::vector<Vec3d>& points) {
  const Bounds bounds = bounds_of(points);
  const Vec3d low = bounds.low, size = bounds.size();
  const double extent = std::max({size.x, size.y, size.z});
  const double scale = extent > 0 ? 0x1p38 / extent : 0;
  std::vector<Lattice> grid;
  for (const Vec3d& p : points) {
    Lattice corner;
    for (int k = 0; k < 3; ++k) corner[k] = std::llround(scale * (p[k] - low[k]));
    grid.push_back(corner);
  }
  return grid;
}

class Hull {
 public:
  explicit Hull(const std::vector<Lattice>& points) : points_(points) {}

  bool build() {
    if (!start()) return false;
    for (std::size_t f = 0; f < faces_.size(); ++f)
      while (faces_[f].alive && !faces_[f].outside.empty()) add_farthest(static_cast<std::uint32_t>(f));
    return true;
  }

  std::vector<std::array<std::uint32_t, 3>> triangles() const {
    std::vector<std::array<std::uint32_t, 3>> found;
    for (const Face& face : faces_)
      if (face.alive) found.push_back(face.corners);
    return found;
  }

 private:
  struct Face {
    std::array<std::uint32_t, 3> corners{};
    std::array<std::uint32_t, 3> neighbours{};  // across the edge from corner i to corner i + 1
    Normal normal{};
    std::vector<std::uint32_t> outside;  // points that are strictly above this face, each at one face only
    bool alive = true, visible = false;
  };
  struct Edge {
    std::uint32_t from, to, beyond;  // `beyond`: the face that stays
  };

  Wide height(const Face& face, std::uint32_t point) const {
    return dot_of(face.normal, minus(points_[point], points_[face.corners[0]]));
  }

  std::uint32_t add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    Face face;
    face.corners = {a, b, c};
    face.normal = cross_of(minus(points_[b], points_[a]), minus(points_[c], points_[a]));
    faces_.push_back(std::move(face));
    return static_cast<std::uint32_t>(faces_.size() - 1);
  }

  // The point for which `measure` is largest, if it is above zero.
  template <class Measure>
  std::optional<std::uint32_t> farthest(const Measure& measure) const {
    std::optional<std::uint32_t> found;
    Wide largest = 0;
    for (std::uint32_t i = 0; i < points_.size(); ++i)
      if (const Wide value = measure(points_[i]); value > largest) {
        largest = value;
        found = i;
      }
    return found;
  }

  // A tetrahedron of four points that are far apart.
  bool start() {
    if (points_.empty()) return false;
    const auto b = farthest([&](const Lattice& p) {
      const Lattice d = minus(p, points_[0]);
      return std::max({size_of(d[0]), size_of(d[1]), size_of(d[2])});
    });
    if (!b) return false;
    const Lattice edge = minus(points_[*b], points_[0]);
    const auto c = farthest([&](const Lattice& p) {
      const Normal n = cross_of(edge, minus(p, points_[0]));
      return std::max({size_of(n[0]), size_of(n[1]), size_of(n[2])});
    });
    if (!c) return false;
    const Normal normal = cross_of(edge, minus(points_[*c], points_[0]));
    const auto d = farthest([&](const Lattice& p) { return size_of(dot_of(normal, minus(p, points_[0]))); });
    if (!d) return false;
    std::array<std::uint32_t, 4> t{0, *b, *c, *d};
    if (dot_of(normal, minus(points_[*d], points_[0])) > 0) std::swap(t[1], t[2]);
    // Now the fourth corner is below the face of the other three.
    add_face(t[0], t[1], t[2]);
    add_face(t[0], t[3], t[1]);
    add_face(t[1], t[3], t[2]);
    add_face(t[2], t[3], t[0]);
    faces_[0].neighbours = {1, 2, 3};
    faces_[1].neighbours = {3, 2, 0};
    faces_[2].neighbours = {1, 3, 0};
    faces_[3].neighbours = {2, 1, 0};
    std::vector<std::uint32_t> all(points_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    distribute(all, 0);
    return true;
  }

  // Gives each point to the first of the faces from `first` on that it is above; the others are inside.
  void distribute(const std::vector<std::uint32_t>& points, std::size_t first) {
    for (const std::uint32_t point : points)
      for (std::size_t f = first; f < faces_.size(); ++f)
        if (height(faces_[f], point) > 0) {
          faces_[f].outside.push_back(point);
          break;
        }
  }

  void add_farthest(std::uint32_t from) {
    std::uint32_t apex = faces_[from].outside.front();
    for (const std::uint32_t point : faces_[from].outside)
      if (height(faces_[from], point) > height(faces_[from], apex)) apex = point;

    // All faces that the apex sees, or in whose plane it is: faces in its plane are replaced by larger ones,
    // and no new face is degenerate.
    std::vector<std::uint32_t> seen{from};
    std::vector<Edge> horizon;
    faces_[from].visible = true;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Face& face = faces_[seen[i]];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t other = face.neighbours[k];
        if (faces_[other].visible) continue;
        if (height(faces_[other], apex) >= 0) {
          faces_[other].visible = true;
          seen.push_back(other);
        } else {
          horizon.push_back({face.corners[k], face.corners[(k + 1) % 3], other});
        }
      }
    }

    std::vector<std::uint32_t> loose;
    for (const std::uint32_t f : seen) {
      faces_[f].alive = false;
      loose.insert(loose.end(), faces_[f].outside.begin(), faces_[f].outside.end());
      faces_[f].outside = {};
    }
    const std::size_t first = faces_.size();
    for (const Edge& edge : horizon) {
      const std::uint32_t f = add_face(edge.from, edge.to, apex);
      faces_[f].neighbours[0] = edge.beyond;
      Face& beyond = faces_[edge.beyond];
      for (std::size_t k = 0; k < 3; ++k)
        if (beyond.corners[k] == edge.to && beyond.corners[(k + 1) % 3] == edge.from)
          beyond.neighbours[k] = f;
    }
    // The horizon is one loop: the edge that begins where another ends is the next one.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> begins;  // corner, new face
    for (std::size_t i = 0; i < horizon.size(); ++i)
      begins.emplace_back(horizon[i].from, static_cast<std::uint32_t>(first + i));
    std::sort(begins.begin(), begins.end());
    for (std::size_t i = 0; i < horizon.size(); ++i) {
      const auto next = std::lower_bound(begins.begin(), begins.end(), std::pair{horizon[i].to, 0u})->second;
      faces_[first + i].neighbours[1] = next;
      faces_[next].neighbours[2] = static_cast<std::uint32_t>(first + i);
    }
    distribute(loose, first);
  }

  const std::vector<Lattice>& points_;
  std::vector<Face> faces_;
};

}  // namespace

std::optional<TriangleMesh> convex_hull(const std::vector<Vec3d>& points) {
  const std::vector<Lattice> grid = on_grid(points);
  Hull hull(grid);
  if (!hull.build()) return {};
  TriangleMesh mesh;
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(points.size(), none);
  for (auto triangle : hull.triangles()) {
    for (std::uint32_t& corner : triangle) {
      if (number[corner] == none) {
        number[corner] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(points[corner]);
      }
      corner = number[corner];
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace tandem
