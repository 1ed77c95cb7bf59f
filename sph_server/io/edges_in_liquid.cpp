#include "sph_server/io/edges_in_liquid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/geometry/mass_properties.hpp"

namespace tandem::sph {
namespace {

// Two faces meet in a sharp edge where their normals are further apart than this; facets of round surfaces
// are not.
constexpr double cosine_of_sharp = 0.866;  // 30 degrees

// Calls each(x) for points `apart` from each other along the sharp convex edges of a solid with its normals
// outwards, `off` away from the edge on the bisector of its faces, until it returns true.
template <class Each>
bool any_beside_edges(const TriangleMesh& solid, double apart, double off, Each each) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> triangle_of;
  for (std::size_t t = 0; t < solid.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      triangle_of[{solid.triangles[t][k], solid.triangles[t][(k + 1) % 3]}] = t;
  const auto corner = [&](std::size_t t, std::size_t k) { return solid.vertices[solid.triangles[t][k % 3]]; };
  const auto normal = [&](std::size_t t) {
    return normalized(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
  };
  for (const auto& [edge, t] : triangle_of) {
    if (edge.first > edge.second) continue;
    const auto other = triangle_of.find({edge.second, edge.first});
    if (other == triangle_of.end()) continue;
    const Vec3d n = normal(t), m = normal(other->second), begin = solid.vertices[edge.first],
                end = solid.vertices[edge.second];
    // Convex: the other triangle is below the plane of this one.
    double below = 0;
    for (std::size_t k = 0; k < 3; ++k) below = std::min(below, dot(corner(other->second, k) - begin, n));
    if (dot(n, m) > cosine_of_sharp || !(below < -1e-9 * norm(end - begin)) || !(norm2(n + m) > 0)) continue;
    const Vec3d away = off * normalized(n + m);
    const int count = std::max(1, static_cast<int>(std::ceil(norm(end - begin) / apart)));
    for (int k = 0; k < count; ++k)
      if (each(begin + ((k + 0.5) / count) * (end - begin) + away)) return true;
  }
  return false;
}

// The triangles of one wall.
TriangleMesh part_of(const BodyWalls& walls, const std::string& name) {
  TriangleMesh part;
  std::map<std::uint32_t, std::uint32_t> number;
  for (std::size_t k = 0; k < walls.mesh.triangles.size(); ++k) {
    if (walls.wall[k] != name) continue;
    auto& triangle = part.triangles.emplace_back(walls.mesh.triangles[k]);
    for (std::uint32_t& vertex : triangle) {
      const auto [known, is_new] = number.emplace(vertex, static_cast<std::uint32_t>(part.vertices.size()));
      if (is_new) part.vertices.push_back(walls.mesh.vertices[vertex]);
      vertex = known->second;
    }
  }
  return part;
}

// The least extent of a mesh along the axes of a frame [m].
double least_extent(const TriangleMesh& mesh, const Pose& frame) {
  const Quat into = frame.q_WB.conjugate();
  Vec3d low = into.rotate(mesh.vertices.front()), high = low;
  for (const Vec3d& vertex : mesh.vertices) {
    const Vec3d v = into.rotate(vertex);
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], v[a]);
      high[a] = std::max(high[a], v[a]);
    }
  }
  const Vec3d size = high - low;
  return std::min({size.x, size.y, size.z});
}

bool is_in(const scene::Box& box, Vec3d x) {
  for (int a = 0; a < 3; ++a)
    if (x[a] < box.min[a] || x[a] > box.max[a]) return false;
  return true;
}

}  // namespace

double missing_percent(double across) {
  return std::min(30 / across, 100.0);
}

std::vector<std::string> edges_in_liquid(const scene::Scene& scene, const std::vector<BodyWalls>& walls,
                                         std::span<const particles::BodyPose> poses,
                                         const std::vector<FilledInside>& insides) {
  std::vector<std::string> sentences;
  const scene::Sph& sph = scene.sph.value();
  const std::vector<scene::Box> boxes = boxes_of(sph.liquids.front());
  const Vec3d up = insides.empty() ? Vec3d{} : -1.0 / norm(scene.gravity) * scene.gravity;
  const auto in_liquid = [&](Vec3d x) {
    return std::ranges::any_of(boxes, [&](const scene::Box& box) { return is_in(box, x); }) ||
           std::ranges::any_of(insides, [&](const FilledInside& filled) { return is_below(filled, x, up); });
  };
  for (const scene::Wall& wall : sph.walls)
    for (std::size_t b = 0; b < walls.size(); ++b) {
      if (walls[b].body != wall.body) continue;
      TriangleMesh mesh = part_of(walls[b], wall.name);
      if (mesh.triangles.empty()) continue;
      const double extent = least_extent(mesh, wall.pose), across = extent / sph.spacing;
      if (!(across < enough_across * (1 - 1e-9)) || !why_not_solid(mesh).empty()) continue;
      if (is_inside_out(mesh)) turn_over(mesh);
      // Three digits of it are no more than what is enough.
      const double finer = 0.995 * extent / enough_across;
      // The first layer of the liquid is half a spacing away from both faces.
      const double off = std::sqrt(0.5) * sph.spacing;
      if (!any_beside_edges(mesh, sph.spacing, off,
                            [&](Vec3d x) { return in_liquid(poses[b].p + poses[b].R * x); }))
        continue;
      sentences.push_back(fmt::format(
          "sph: wall '{}' of '{}' has sharp edges in the liquid and is {:.3g} m across, {:.3g} spacings: the "
          "liquid there does not come to rest, and the mean of loads on it, such as its buoyancy, may be up "
          "to {:.0f} % "
          "too small. Give a spacing of {:.3g} m or less, for {:.0f} spacings across",
          wall.name, scene.body_name(wall.body), extent, across, missing_percent(across), finer,
          enough_across));
    }
  return sentences;
}

}  // namespace tandem::sph
