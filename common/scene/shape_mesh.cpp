#include "common/scene/shape_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/convex_hull.hpp"
#include "common/geometry/solid_mesh.hpp"
#include "common/scene/fault.hpp"

namespace tandem::scene {

namespace {

template <class... F>
struct EachShape : F... {
  using F::operator()...;
};
template <class... F>
EachShape(F...) -> EachShape<F...>;

double deviation_of_prism(double radius, std::optional<int> segments) {
  return segments ? radius * (1 - std::cos(std::numbers::pi / *segments)) : 0;
}

}  // namespace

const std::string& file_of(const Geometry& geometry) {
  static const std::string none;
  if (const auto* mesh = std::get_if<MeshShape>(&geometry)) return mesh->file;
  if (const auto* hull = std::get_if<HullShape>(&geometry)) return hull->file;
  return none;
}

double scale_of(const Geometry& geometry) {
  if (const auto* mesh = std::get_if<MeshShape>(&geometry)) return mesh->scale;
  if (const auto* hull = std::get_if<HullShape>(&geometry)) return hull->scale;
  return 1;
}

Vec3d stretch_of(const Geometry& geometry) {
  const auto* mesh = std::get_if<MeshShape>(&geometry);
  return mesh ? mesh->stretch : Vec3d{1, 1, 1};
}

Vec3d units_of(const Geometry& geometry) {
  return scale_of(geometry) * stretch_of(geometry);
}

std::string scale_text(double scale, Vec3d stretch) {
  if (stretch.x == 1 && stretch.y == 1 && stretch.z == 1) return fmt::format("{:.3g}", scale);
  return fmt::format("{:.3g} and a stretch of [{:.3g}, {:.3g}, {:.3g}]", scale, stretch.x, stretch.y,
                     stretch.z);
}

std::string contact_mesh_name(const Scene& scene, const Shape& shape) {
  return scene.body_name(shape.body) + "/" + shape.name;
}

std::string name_of(const Geometry& geometry) {
  return std::visit(
      EachShape{[](const PlaneShape&) { return "plane"; }, [](const BoxShape&) { return "box"; },
                [](const CylinderShape&) { return "cylinder"; }, [](const SphereShape&) { return "sphere"; },
                [](const MeshShape&) { return "mesh"; }, [](const CapsuleShape&) { return "capsule"; },
                [](const ConeShape&) { return "cone"; }, [](const HullShape&) { return "convex_hull"; },
                [](const HeightFieldShape&) { return "height_field"; }},
      geometry);
}

bool is_bounded(const Geometry& geometry) {
  const auto* cylinder = std::get_if<CylinderShape>(&geometry);
  return !std::holds_alternative<PlaneShape>(geometry) && (!cylinder || cylinder->height);
}

bool is_made_of_facets(const Geometry& geometry) {
  return std::holds_alternative<CapsuleShape>(geometry) || std::holds_alternative<ConeShape>(geometry) ||
         std::holds_alternative<HullShape>(geometry) || std::holds_alternative<HeightFieldShape>(geometry);
}

double deviation_of_facets(const Geometry& geometry) {
  if (const auto* cylinder = std::get_if<CylinderShape>(&geometry))
    return deviation_of_prism(cylinder->radius, cylinder->segments);
  // Half a cell between two meridians and half a zone away from the corners of a facet of the sphere.
  if (const auto* capsule = std::get_if<CapsuleShape>(&geometry); capsule && capsule->segments) {
    const double half_cell = std::numbers::pi / *capsule->segments,
                 half_zone = std::numbers::pi / 4 / std::max(2, (*capsule->segments + 3) / 4);
    return capsule->radius * (1 - std::cos(half_cell) * std::cos(half_zone));
  }
  if (const auto* cone = std::get_if<ConeShape>(&geometry))
    return deviation_of_prism(std::max(cone->radius, cone->top_radius), cone->segments);
  return 0;
}

TriangleMesh mesh_of(const Shape& shape, const TriangleMesh& in_file, int segments,
                     const std::string& origin) {
  const auto hull = [&](const HullShape& s) {
    std::optional<TriangleMesh> mesh = convex_hull(s.file.empty() ? s.points : in_file.vertices);
    if (!mesh)
      fail(origin, shape.path + ".shape", "the points of the hull lie in one plane",
           "add points outside of it");
    return std::move(*mesh);
  };
  return std::visit(
      EachShape{
          [](const PlaneShape&) { return TriangleMesh{}; },
          [](const BoxShape& s) { return box_mesh(s.size, s.open); },
          [&](const CylinderShape& s) {
            return cylinder_mesh(s.radius, s.height.value_or(0), s.segments.value_or(segments), s.open);
          },
          [&](const SphereShape& s) { return sphere_mesh(s.radius, segments); },
          [&](const MeshShape&) { return in_file; },
          [&](const CapsuleShape& s) {
            return capsule_mesh(s.radius, s.height, s.segments.value_or(segments));
          },
          [&](const ConeShape& s) {
            return cone_mesh(s.radius, s.top_radius, s.height, s.segments.value_or(segments), s.open);
          },
          hull,
          [](const HeightFieldShape& s) { return height_field_mesh(s.size_x, s.size_y, s.heights, s.base); }},
      shape.geometry);
}

Wall wall_of(const Shape& shape) {
  Wall wall{shape.name,
            shape.body,
            shape.material.value_or(MaterialId{}),
            shape.pose,
            {},
            shape.path,
            shape.surface_velocity,
            shape.colour};
  std::visit(
      [&](const auto& geometry) {
        if constexpr (requires { wall.shape = geometry; })
          wall.shape = geometry;
        else
          wall.shape = MeshShape{"facets of wall " + shape.name, 1};
      },
      shape.geometry);
  return wall;
}

}  // namespace tandem::scene
