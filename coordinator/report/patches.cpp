#include "coordinator/report/patches.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "coordinator/report/edge_key.hpp"

namespace tandem::launch {
namespace {

constexpr std::size_t most_points = 400;  // that are looked for
constexpr double most_tests = 2e7;        // of a point and a triangle, for one surface
constexpr double clearest = 0.92;

// The last triangle with an edge.
struct Neighbour {
  std::size_t triangle = 0;
  Vec3d normal;
};

// Roots of a forest of triangles that belong together.
std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Whether the line from `eye` to `point` passes the triangle a b c [Ericson2005, 5.3.6].
bool is_between(Vec3d eye, Vec3d point, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d along = point - eye, ab = b - a, ac = c - a, p = cross(along, ac);
  const double determinant = dot(ab, p);
  if (determinant == 0) return false;
  const Vec3d from = eye - a, q = cross(from, ab);
  const double u = dot(from, p) / determinant, v = dot(along, q) / determinant, t = dot(ac, q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < 1;
}

}  // namespace

std::vector<Patch> patches_of(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<std::size_t> parent(count);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  std::map<EdgeKey, Neighbour> edges;
  for (std::size_t t = 0; t < count; ++t) {
    const Vec3d corner[3] = {mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]],
                             mesh.vertices[mesh.triangles[t][2]]};
    const Vec3d area = cross(corner[1] - corner[0], corner[2] - corner[0]);
    if (norm2(area) == 0) continue;
    const Vec3d normal = normalized(area);
    for (int i = 0; i < 3; ++i) {
      const auto [found, is_new] =
          edges.try_emplace(edge_key(corner[i], corner[(i + 1) % 3]), Neighbour{t, normal});
      if (is_new) continue;
      if (dot(found->second.normal, normal) >= cos_sharp)
        parent[root_of(parent, t)] = root_of(parent, found->second.triangle);
      found->second = {t, normal};
    }
  }
  std::vector<Patch> patches;
  std::map<std::size_t, std::size_t> patch_of_root;
  for (std::size_t t = 0; t < count; ++t) {
    const auto [found, is_new] = patch_of_root.try_emplace(root_of(parent, t), patches.size());
    if (is_new) patches.emplace_back();
    patches[found->second].triangles.push_back(mesh.triangles[t]);
  }
  return patches;
}

std::vector<Vec3d> points_to_see(const Frame& frame) {
  const std::size_t spheres = frame.radius.size(),
                    vertices = frame.liquid_surface ? frame.liquid_surface->mesh.vertices.size() : 0;
  const std::size_t all = spheres + vertices, stride = std::max<std::size_t>(1, all / most_points);
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < all; i += stride)
    points.push_back(i < spheres ? frame.centre(i) : frame.liquid_surface->mesh.vertices[i - spheres]);
  return points;
}

void count_hidden(std::vector<Patch>& patches, const TriangleMesh& mesh, const std::vector<Vec3d>& points,
                  Vec3d eye) {
  const auto triangles = static_cast<double>(mesh.triangles.size());
  const auto affordable = static_cast<std::size_t>(std::max(20.0, most_tests / std::max(1.0, triangles)));
  const std::size_t stride = std::max<std::size_t>(1, points.size() / affordable);
  for (Patch& patch : patches) {
    std::size_t looked = 0, behind = 0;
    for (std::size_t i = 0; i < points.size(); i += stride) {
      ++looked;
      behind += std::ranges::any_of(patch.triangles, [&](const std::array<std::uint32_t, 3>& corner) {
        return is_between(eye, points[i], mesh.vertices[corner[0]], mesh.vertices[corner[1]],
                          mesh.vertices[corner[2]]);
      });
    }
    patch.hidden = looked == 0 ? 0 : static_cast<double>(behind) / static_cast<double>(looked);
  }
}

double clearness_of(double hidden, bool fixed) {
  const double solid_below = fixed ? 0.03 : 0.1, clear_from = fixed ? 0.1 : 0.25;
  const double share = std::clamp((hidden - solid_below) / (clear_from - solid_below), 0.0, 1.0);
  return clearest * share * share * (3 - 2 * share);
}

}  // namespace tandem::launch
