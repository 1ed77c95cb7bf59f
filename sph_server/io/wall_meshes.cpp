#include "sph_server/io/wall_meshes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/coarse_mesh.hpp"
#include "common/geometry/mass_properties.hpp"
#include "common/geometry/triangle_tree.hpp"

namespace tandem::sph {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int least_segments = 16;  // fewer would meet at sharp edges, see edges_in_liquid.cpp

// Corners of a regular polygon with the area of the circle are that much outside [radii], and the middles of
// its sides are half as much inside.
double outside(int segments) {
  const double angle = 2 * pi / segments;
  return std::sqrt(angle / std::sin(angle)) - 1;
}
int segments_within(double share) {
  int segments = least_segments;
  while (outside(segments) > share) segments += 4;
  return segments;
}

}  // namespace

FacetedShape faceted(const scene::CylinderShape& cylinder, const std::vector<std::string>& open,
                     double deviation) {
  const double height = cylinder.height.value();
  if (cylinder.segments)
    return {cylinder_mesh(cylinder.radius, height, *cylinder.segments, open), *cylinder.segments, 0};
  const int segments = segments_within(deviation / cylinder.radius);
  const double beyond = outside(segments);
  return {cylinder_mesh((1 + beyond) * cylinder.radius, height, segments, open), segments,
          beyond * cylinder.radius};
}

FacetedShape faceted(const scene::SphereShape& sphere, double deviation) {
  FacetedShape round{{}, least_segments, 0};
  for (;; round.segments += 4) {
    round.mesh = sphere_mesh(1, round.segments);
    const double radius = std::cbrt(4 * pi / 3 / mass_of_mesh(round.mesh, 1).mass);  // of the corners
    round.deviation = (radius - 1) * sphere.radius;
    for (Vec3d& v : round.mesh.vertices) v *= radius * sphere.radius;
    for (const auto& [a, b, c] : round.mesh.triangles) {
      const Vec3d nearest =
          nearest_point(round.mesh.vertices[a], round.mesh.vertices[b], round.mesh.vertices[c], {});
      round.deviation = std::max(round.deviation, sphere.radius - norm(nearest));
    }
    if (round.deviation <= deviation) return round;
  }
}

std::vector<NamedMesh> wall_meshes(const scene::Sph& sph, const std::vector<NamedMesh>& given,
                                   std::vector<std::string>& sentences) {
  std::vector<NamedMesh> all;
  for (const scene::Wall& wall : sph.walls) {
    const auto of = std::ranges::find(given, wall.name, &NamedMesh::name);
    if (of == given.end()) continue;
    CoarseMesh coarse = coarsened(of->mesh, deviation_of(sph));
    if (coarse.mesh.triangles.size() < of->mesh.triangles.size())
      sentences.push_back(
          fmt::format("details of wall '{}' below {:.2g} m: {} of its {} triangles remain for the liquid",
                      wall.name, coarse.deviation, coarse.mesh.triangles.size(), of->mesh.triangles.size()));
    all.push_back({wall.name, std::move(coarse.mesh)});
  }
  return all;
}

}  // namespace tandem::sph
