#include "coordinator/verdict/wall_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/geometry/mass_properties.hpp"
#include "coordinator/results/body_meshes.hpp"

namespace tandem::launch {
namespace {

// Segments of round walls: the inscribed prism is off by less than a hundredth of the radius.
constexpr int watched_segments = 24;
constexpr double cos_of_sharp = 0.87;  // an edge is sharp if its two triangles differ by more than 30 degrees
// Limit for the vertex of a needle, which would otherwise move far past its base [-].
constexpr double longest_shrink = 4;

Vec3d to_body(const Pose& X, Vec3d p) {
  return X.p_WB + X.q_WB.rotate(p);
}

// Vertices at one place become one: mesh files have them once per triangle.
void merge_vertices(TriangleMesh& mesh) {
  std::map<std::array<double, 3>, std::uint32_t> known;
  std::vector<Vec3d> vertices;
  std::vector<std::uint32_t> merged;
  for (const Vec3d& v : mesh.vertices) {
    const auto [at, is_new] = known.try_emplace({v.x, v.y, v.z}, static_cast<std::uint32_t>(vertices.size()));
    if (is_new) vertices.push_back(v);
    merged.push_back(at->second);
  }
  mesh.vertices = std::move(vertices);
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) corner = merged[corner];
  std::erase_if(mesh.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

// The displacement of a vertex to a distance of one metre from each plane of a set, by least squares, and the
// shortest such displacement.
class PlaneSum {
 public:
  void add(Vec3d inner_normal, double weight) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) matrix_[i][j] += weight * inner_normal[i] * inner_normal[j];
      right_[i] += weight * inner_normal[i];
    }
    weight_ += weight;
  }
  Vec3d way() const {
    if (weight_ == 0) return {};
    // Selects the shortest of many displacements; too small to change it.
    const double least = 1e-6 * weight_;
    const Vec3d a{matrix_[0][0] + least, matrix_[1][0], matrix_[2][0]},
        b{matrix_[0][1], matrix_[1][1] + least, matrix_[2][1]},
        c{matrix_[0][2], matrix_[1][2], matrix_[2][2] + least};
    const double size = dot(a, cross(b, c));
    const Vec3d way =
        (1 / size) * Vec3d{dot(right_, cross(b, c)), dot(a, cross(right_, c)), dot(a, cross(b, right_))};
    return std::min(1.0, longest_shrink / norm(way)) * way;
  }

 private:
  double matrix_[3][3] = {}, weight_ = 0;
  Vec3d right_;
};

double area_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    sum += norm(cross(mesh.vertices[j] - mesh.vertices[i], mesh.vertices[k] - mesh.vertices[i])) / 2;
  return sum;
}

}  // namespace

WallSurface make_surface(const scene::Wall& wall, const scene::Scene& scene,
                         const std::vector<NamedMesh>& meshes) {
  WallSurface s;
  s.wall = &wall;
  if (const auto* plane = std::get_if<scene::PlaneShape>(&wall.shape)) {
    s.plane = true;
    s.point = to_body(wall.pose, plane->point);
    s.normal = normalized(wall.pose.q_WB.rotate(plane->normal));
    s.thickness = std::numeric_limits<double>::infinity();
    return s;
  }
  s.mesh = wall_mesh(wall, scene, meshes, watched_segments);
  merge_vertices(s.mesh);
  const std::vector<Vec3d>& at = s.mesh.vertices;
  const Bounds bounds = bounds_of(at);
  s.centre = bounds.middle();
  s.half = 0.5 * bounds.size();
  for (const Vec3d& v : at) s.radius = std::max(s.radius, norm(v - s.centre));
  Bounds own;
  for (const Vec3d& v : at) own.add(wall.pose.q_WB.conjugate().rotate(v - wall.pose.p_WB));
  const Vec3d size = own.size();
  // A sheet has no thickness of its own.
  s.thickness = std::max(std::min({size.x, size.y, size.z}), 0.01 * std::max({size.x, size.y, size.z}));

  // For each edge, its triangles and the number of the side in each.
  std::map<std::array<std::uint32_t, 2>, std::vector<std::array<std::size_t, 2>>> edges;
  std::vector<Vec3d> normals;
  for (std::size_t t = 0; t < s.mesh.triangles.size(); ++t) {
    const auto& [i, j, k] = s.mesh.triangles[t];
    normals.push_back(normalized(cross(at[j] - at[i], at[k] - at[i])));
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t from = s.mesh.triangles[t][side], to = s.mesh.triangles[t][(side + 1) % 3];
      edges[{std::min(from, to), std::max(from, to)}].push_back({t, side});
    }
  }
  s.closed =
      std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second.size() == 2; });
  s.sharp.resize(s.mesh.triangles.size());
  std::vector<PlaneSum> planes(at.size());
  for (const auto& [edge, sides] : edges) {
    s.edges.push_back(edge);
    const bool smooth = sides.size() == 2 && dot(normals[sides[0][0]], normals[sides[1][0]]) > cos_of_sharp;
    for (const auto& [t, k] : sides) s.sharp[t][k] = !smooth;
    if (s.closed || sides.size() != 1) continue;
    const auto& [t, k] = sides.front();
    const std::uint32_t from = s.mesh.triangles[t][k], to = s.mesh.triangles[t][(k + 1) % 3];
    const Vec3d inner = normalized(cross(normals[t], at[to] - at[from]));
    for (const std::uint32_t v : edge) planes[v].add(inner, 1);
  }
  if (s.closed) {
    const double volume = signed_volume(s.mesh), inner = volume < 0 ? 1 : -1;
    s.most_shrink = std::abs(volume) / (2 * area_of(s.mesh));
    for (std::size_t t = 0; t < s.mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d here = at[s.mesh.triangles[t][k]], u = at[s.mesh.triangles[t][(k + 1) % 3]] - here,
                    v = at[s.mesh.triangles[t][(k + 2) % 3]] - here;
        // Weighted by its angle, a face counts the same however it is divided into triangles.
        planes[s.mesh.triangles[t][k]].add(inner * normals[t], std::atan2(norm(cross(u, v)), dot(u, v)));
      }
  }
  for (const PlaneSum& sum : planes) s.shrink.push_back(sum.way());
  return s;
}

bool is_inside(Vec3d point, const WallSurface& surface, const std::vector<Vec3d>& at) {
  Bounds bounds = bounds_of(at), of_point;
  of_point.add(point);
  if (!bounds.overlaps(of_point)) return false;
  return std::abs(winding_number(surface.mesh, at, point)) > 0.5;
}

}  // namespace tandem::launch
