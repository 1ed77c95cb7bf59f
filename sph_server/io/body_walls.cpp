#include "sph_server/io/body_walls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "sph_server/io/patches.hpp"
#include "sph_server/io/wall_meshes.hpp"

namespace tandem::sph {
namespace {

// A square of the plane that the domain does not reach beyond.
TriangleMesh square_of(const scene::PlaneShape& plane, const Pose& pose, const scene::Sph& sph) {
  const Vec3d normal = normalized(pose.q_WB.rotate(plane.normal)),
              point = pose.p_WB + pose.q_WB.rotate(plane.point);
  const Vec3d middle = 0.5 * (sph.domain.min + sph.domain.max),
              centre = middle - dot(middle - point, normal) * normal;
  const Vec3d helper = std::fabs(normal.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const double half = norm(sph.domain.max - sph.domain.min) + 4 * sph.spacing;
  const Vec3d u = half * normalized(cross(normal, helper)), v = cross(normal, u);
  return {{centre - u - v, centre + u - v, centre + u + v, centre - u + v}, {{0, 1, 2}, {0, 2, 3}}};
}

void append(const TriangleMesh& mesh, TriangleMesh& to) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const auto& t : mesh.triangles) to.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

const TriangleMesh& mesh_of(const scene::Wall& wall, const std::vector<NamedMesh>& meshes) {
  const auto named = std::ranges::find(meshes, wall.name, &NamedMesh::name);
  if (named == meshes.end())
    throw Error(ErrorCode::protocol, "no mesh came with wall '" + wall.name + "'", "sph.walls",
                "the coordinator must send the mesh of every wall");
  return named->mesh;
}

// Two triangles at one place would act twice, whichever way they face.
void refuse_doubles(const std::string& wall, const TriangleMesh& mesh) {
  std::set<std::array<std::array<double, 3>, 3>> known;
  std::size_t doubles = 0;
  Vec3d where;
  for (const auto& t : mesh.triangles) {
    std::array<std::array<double, 3>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d v = mesh.vertices[t[k]];
      corners[k] = {v.x, v.y, v.z};
    }
    std::ranges::sort(corners);
    if (known.insert(corners).second) continue;
    if (doubles++ == 0) where = 1.0 / 3 * (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]);
  }
  if (doubles > 0)
    throw Error(
        ErrorCode::scene,
        fmt::format("{} of {} triangles of wall '{}' are there twice, one of them at {} m of the mesh: they "
                    "would act twice on the liquid",
                    doubles, mesh.triangles.size(), wall, scene::rounded(where)),
        "sph.walls",
        "remove the doubles in the program that made the mesh; a sheet is one layer of "
        "triangles, which hold the liquid on both sides");
}

// Whether a sensor measures the load on this wall alone.
bool is_sensed(const scene::Sph& sph, const scene::Wall& wall) {
  return std::ranges::any_of(sph.sensors, [&](const scene::LiquidSensor& s) { return s.wall == wall.name; });
}

BodyWalls part_of(const BodyWalls& whole, TriangleMesh mesh, const std::vector<std::size_t>& from) {
  BodyWalls part = whole;
  part.mesh = std::move(mesh);
  part.wall.clear();
  for (const std::size_t t : from) part.wall.push_back(whole.wall[t]);
  return part;
}

// Makes the walls in the area of a sensor parts for themselves, in front of what is left of them.
void set_apart(const scene::LiquidSensor& sensor, std::vector<BodyWalls>& all) {
  std::vector<BodyWalls> parts;
  bool found = false;
  for (const BodyWalls& walls : all) {
    CutMesh cut;
    if (walls.body == sensor.body && walls.patch.empty())
      cut = cut_by_box(walls.mesh, sensor.pose, patch_size(*sensor.area));
    if (cut.inside.triangles.empty()) {
      parts.push_back(walls);
      continue;
    }
    found = true;
    BodyWalls& patch = parts.emplace_back(part_of(walls, std::move(cut.inside), cut.inside_of));
    patch.patch = sensor.name;
    patch.approximations.clear();
    if (!cut.outside.triangles.empty())
      parts.push_back(part_of(walls, std::move(cut.outside), cut.outside_of));
  }
  if (!found)
    throw Error(
        ErrorCode::scene,
        fmt::format("no wall of its body is in the area of sensor '{}', {:.4g} x {:.4g} m and up to "
                    "{:.4g} m along its z axis",
                    sensor.name, sensor.area->x, sensor.area->y, 0.5 * patch_size(*sensor.area).z),
        "sph.sensors",
        "move it onto a wall that no other sensor's area covers, and turn its z axis into the liquid");
  all = std::move(parts);
}

}  // namespace

bool is_slip(const scene::Sph& sph, BodyId body) {
  const auto pair = std::ranges::find(sph.pairs, body, &scene::LiquidPair::body);
  return (pair == sph.pairs.end() ? sph.wall_friction : pair->wall_friction) ==
         scene::WallFriction::free_slip;
}

TriangleMesh whole_mesh_of(const scene::Wall& wall, const scene::Sph& sph,
                           const std::vector<NamedMesh>& meshes) {
  TriangleMesh mesh;
  if (const auto* box = std::get_if<scene::BoxShape>(&wall.shape))
    mesh = box_mesh(box->size);
  else if (const auto* cylinder = std::get_if<scene::CylinderShape>(&wall.shape))
    mesh = faceted(*cylinder, {}, deviation_of(sph)).mesh;
  else if (const auto* sphere = std::get_if<scene::SphereShape>(&wall.shape))
    mesh = faceted(*sphere, deviation_of(sph)).mesh;
  else
    mesh = mesh_of(wall, meshes);
  return transformed(std::move(mesh), wall.pose);
}

bool is_inside_out(const TriangleMesh& mesh) {
  double volume = 0;
  const Vec3d origin = mesh.vertices.front();
  for (const auto& t : mesh.triangles)
    volume +=
        dot(mesh.vertices[t[0]] - origin, cross(mesh.vertices[t[1]] - origin, mesh.vertices[t[2]] - origin));
  return volume < 0;
}

void turn_over(TriangleMesh& mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

std::vector<BodyWalls> walls_of_bodies(const scene::Scene& scene, const std::vector<NamedMesh>& meshes) {
  const scene::Sph& sph = scene.sph.value();
  // Names of walls are not empty: what no sensor measures is last of its body.
  std::map<std::tuple<BodyId, bool, std::string>, BodyWalls> groups;
  for (const scene::Wall& wall : sph.walls) {
    const bool alone = is_sensed(sph, wall);
    const std::string sensed = alone ? wall.name : "";
    BodyWalls& group = groups[{wall.body, !alone, sensed}];
    group.body = wall.body;
    group.sensed = sensed;
    const auto add = [&](const TriangleMesh& mesh) { append(transformed(mesh, wall.pose), group.mesh); };
    const auto add_round = [&](const FacetedShape& round) {
      add(round.mesh);
      if (round.deviation > 0)
        group.approximations.push_back(
            fmt::format("wall '{}' has {} flat faces around, at most {:.2g} m off its round surface",
                        wall.name, round.segments, round.deviation));
    };
    if (const auto* plane = std::get_if<scene::PlaneShape>(&wall.shape)) {
      append(square_of(*plane, wall.pose, sph), group.mesh);
    } else if (const auto* box = std::get_if<scene::BoxShape>(&wall.shape)) {
      add(box_mesh(box->size, box->open));
    } else if (const auto* cylinder = std::get_if<scene::CylinderShape>(&wall.shape)) {
      add_round(faceted(*cylinder, cylinder->open, deviation_of(sph)));
    } else if (const auto* sphere = std::get_if<scene::SphereShape>(&wall.shape)) {
      add_round(faceted(*sphere, deviation_of(sph)));
    } else {
      refuse_doubles(wall.name, mesh_of(wall, meshes));
      add(mesh_of(wall, meshes));
    }
    group.wall.resize(group.mesh.triangles.size(), wall.name);
  }
  std::vector<BodyWalls> all;
  for (auto& [key, group] : groups) all.push_back(std::move(group));
  for (const scene::LiquidSensor& sensor : sph.sensors)
    if (sensor.area) set_apart(sensor, all);
  return all;
}

}  // namespace tandem::sph
