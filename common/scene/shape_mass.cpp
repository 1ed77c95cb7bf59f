#include "common/scene/shape_mass.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/bounds.hpp"
#include "common/overloaded.hpp"
#include "common/scene/fault.hpp"
#include "common/scene/shape_mesh.hpp"

namespace tandem::scene {

namespace {

// Of the meshes by which overlaps are looked for.
constexpr int coarse_segments = 32;

// A shape with a mass.
class Solid {
 public:
  Solid(const Shape& shape, double density, const TriangleMesh& in_file, const std::string& origin)
      : shape_(shape), mesh_(tandem::scene::mesh_of(shape, in_file, coarse_segments, origin)) {
    const auto of_mesh = [&] {
      exact_ = true;
      if (const std::string why = why_not_solid(mesh_); !why.empty())
        fail(origin, shape.path + ".shape", "the " + name_of(shape.geometry) + " encloses no volume: " + why,
             "close it in the program that made it, or give \"density\": 0");
      return mass_of_mesh(mesh_, density);
    };
    mass_ = placed(
        std::visit(Overloaded{[&](const BoxShape& s) { return mass_of_box(s.size, density); },
                              [&](const SphereShape& s) { return mass_of_sphere(s.radius, density); },
                              [&](const CylinderShape& s) {
                                return s.segments ? of_mesh()
                                                  : mass_of_cylinder(s.radius, *s.height, density);
                              },
                              [&](const CapsuleShape& s) {
                                return s.segments ? of_mesh() : mass_of_capsule(s.radius, s.height, density);
                              },
                              [&](const ConeShape& s) {
                                return s.segments ? of_mesh()
                                                  : mass_of_cone(s.radius, s.top_radius, s.height, density);
                              },
                              [&](const auto&) { return of_mesh(); }},
                   shape.geometry),
        shape.pose);
    for (const Vec3d& vertex : mesh_.vertices) bounds_.add(shape.pose.p_WB + shape.pose.q_WB.rotate(vertex));
  }

  const Shape& shape() const { return shape_; }
  const MassProperties& mass() const { return mass_; }
  const Bounds& bounds() const { return bounds_; }
  std::size_t triangles() const { return mesh_.triangles.size(); }

  // Whether a point of the body is inside.
  bool contains(Vec3d point) const {
    const Vec3d p = shape_.pose.q_WB.conjugate().rotate(point - shape_.pose.p_WB);
    const double r2 = p.x * p.x + p.y * p.y;
    if (!exact_) {
      if (const auto* box = std::get_if<BoxShape>(&shape_.geometry))
        return 2 * std::abs(p.x) < box->size.x && 2 * std::abs(p.y) < box->size.y &&
               2 * std::abs(p.z) < box->size.z;
      if (const auto* sphere = std::get_if<SphereShape>(&shape_.geometry))
        return r2 + p.z * p.z < sphere->radius * sphere->radius;
      if (const auto* cylinder = std::get_if<CylinderShape>(&shape_.geometry))
        return r2 < cylinder->radius * cylinder->radius && 2 * std::abs(p.z) < *cylinder->height;
    }
    return std::abs(winding_number(mesh_, p)) > 0.5;
  }

  // Whether a point of the body is inside twice, where parts of the mesh pass through each other.
  bool contains_twice(Vec3d point) const {
    const Vec3d p = shape_.pose.q_WB.conjugate().rotate(point - shape_.pose.p_WB);
    return exact_ && std::abs(winding_number(mesh_, p)) > 1.5;
  }

 private:
  const Shape& shape_;
  TriangleMesh mesh_;
  bool exact_ = false;  // the mesh is the shape itself
  MassProperties mass_;
  Bounds bounds_;  // in the body's frame
};

double radical_inverse(std::uint32_t index, std::uint32_t base) {
  double value = 0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) value += digit * (index % base);
  return value;
}

// The volume in which a condition holds, by points of a Halton sequence in a box. `triangles`: that each
// point is compared with.
template <class Condition>
double volume_where(const Condition& holds, Vec3d low, Vec3d size, std::size_t triangles) {
  constexpr std::size_t most_points = 4096, fewest_points = 64, most_work = 20'000'000;
  const std::size_t points =
      std::clamp(most_work / std::max<std::size_t>(1, triangles), fewest_points, most_points);
  std::size_t inside = 0;
  for (std::uint32_t i = 1; i <= points; ++i)
    if (holds(low + Vec3d{size.x * radical_inverse(i, 2), size.y * radical_inverse(i, 3),
                          size.z * radical_inverse(i, 5)}))
      ++inside;
  return size.x * size.y * size.z * static_cast<double>(inside) / static_cast<double>(points);
}

// The common volume of two solids, in the common part of their bounding boxes.
double common_volume(const Solid& a, const Solid& b) {
  Vec3d low, size;
  for (int k = 0; k < 3; ++k) {
    low[k] = std::max(a.bounds().low[k], b.bounds().low[k]);
    size[k] = std::min(a.bounds().high[k], b.bounds().high[k]) - low[k];
    const double extent =
        std::max(a.bounds().high[k] - a.bounds().low[k], b.bounds().high[k] - b.bounds().low[k]);
    if (!(size[k] > 1e-9 * extent)) return 0;
  }
  return volume_where([&](Vec3d p) { return a.contains(p) && b.contains(p); }, low, size,
                      a.triangles() + b.triangles());
}

void warn_of_parts(const Solid& solid, const std::string& body, std::vector<std::string>& warnings) {
  if (!std::holds_alternative<MeshShape>(solid.shape().geometry)) return;
  const double volume = volume_where([&](Vec3d p) { return solid.contains_twice(p); }, solid.bounds().low,
                                     solid.bounds().size(), solid.triangles());
  if (volume > 0)
    warnings.push_back("parts of the mesh of shape \"" + solid.shape().name + "\" of body \"" + body +
                       "\" pass through each other in some " + rounded(volume) +
                       " m3, where their mass counts twice: unite them in the program that made the mesh");
}

// Names the first two shapes that overlap, and counts the others.
void warn_of_overlaps(const std::vector<Solid>& solids, const std::string& body,
                      std::vector<std::string>& warnings) {
  std::size_t pairs = 0;
  std::string first;
  for (std::size_t i = 0; i < solids.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (const double volume = common_volume(solids[k], solids[i]); volume > 0 && ++pairs == 1)
        first = "shapes \"" + solids[k].shape().name + "\" and \"" + solids[i].shape().name +
                "\" of body \"" + body + "\" overlap in some " + rounded(volume) + " m3";
  if (pairs == 0) return;
  const std::string others =
      pairs == 1 ? "" : ", and so do " + std::to_string(pairs - 1) + " other pairs of its shapes";
  warnings.push_back(
      first + others +
      "; their mass counts twice there: let them touch only, or give one of them \"density\": 0");
}

void shift(Pose& pose, Vec3d centre) {
  pose.p_WB = pose.p_WB - centre;
}

}  // namespace

double density_of(const Shape& shape, const Scene& scene) {
  if (shape.density) return *shape.density;
  return shape.material ? scene.dem->materials[shape.material->value].density : 0;
}

std::vector<ShapedBody> take_mass_from_shapes(Scene& scene, const std::vector<TriangleMesh>& in_files,
                                              const std::string& origin, std::vector<std::string>& warnings) {
  std::vector<ShapedBody> shaped;
  if (!scene.mbd) return shaped;
  std::vector<std::vector<std::size_t>> shapes_of(scene.mbd->bodies.size());
  for (std::size_t i = 0; i < scene.shapes.size(); ++i)
    if (scene.shapes[i].is_of_body) shapes_of[scene.shapes[i].body.value].push_back(i);

  std::vector<Vec3d> centres(scene.mbd->bodies.size());
  for (std::uint32_t b = 0; b < scene.mbd->bodies.size(); ++b) {
    Body& body = scene.mbd->bodies[b];
    if (!body.from_shapes) continue;
    std::vector<Solid> solids;
    std::vector<MassProperties> masses;
    for (const std::size_t i : shapes_of[b]) {
      const double density = density_of(scene.shapes[i], scene);
      if (density == 0) continue;
      solids.emplace_back(scene.shapes[i], density, in_files[i], origin);
      masses.push_back(solids.back().mass());
    }
    for (const Solid& solid : solids) warn_of_parts(solid, body.name, warnings);
    warn_of_overlaps(solids, body.name, warnings);
    const MassProperties all = sum(masses);
    body.mass = all.mass;
    body.inertia = all.inertia;
    body.pose.p_WB += body.pose.q_WB.rotate(all.centre);
    body.from_shapes = false;
    centres[b] = all.centre;
    shaped.push_back({{b}, solids.size(), all});
  }
  const auto shift_by_body = [&](BodyId body, Pose& pose) {
    if (body != ground) shift(pose, centres[body.value]);
  };
  for (Shape& shape : scene.shapes) shift_by_body(shape.body, shape.pose);
  if (scene.sph) {
    for (Wall& wall : scene.sph->walls) shift_by_body(wall.body, wall.pose);
    for (LiquidSensor& sensor : scene.sph->sensors) shift_by_body(sensor.body, sensor.pose);
  }
  if (scene.dem) {
    for (Wall& wall : scene.dem->walls) shift_by_body(wall.body, wall.pose);
    for (ParticleSensor& sensor : scene.dem->sensors) shift_by_body(sensor.body, sensor.pose);
  }
  return shaped;
}

}  // namespace tandem::scene
