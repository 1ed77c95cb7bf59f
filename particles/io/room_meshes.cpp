#include "particles/io/room_meshes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "common/error.hpp"
#include "common/geometry/convex_hull.hpp"
#include "particles/io/overlaps.hpp"

namespace tandem::particles::room {
namespace {

// Of round walls and regions, for what is inside. Walls themselves are exact.
constexpr int segments = 256;

// Corners at one place become one, so that edges know both their triangles.
TriangleMesh joined(const TriangleMesh& mesh) {
  std::map<std::array<double, 3>, std::uint32_t> known;
  TriangleMesh result;
  std::vector<std::uint32_t> to;
  for (const Vec3d& v : mesh.vertices) {
    const auto [entry, is_new] =
        known.try_emplace({v.x, v.y, v.z}, static_cast<std::uint32_t>(result.vertices.size()));
    if (is_new) result.vertices.push_back(v);
    to.push_back(entry->second);
  }
  for (const auto& t : mesh.triangles) result.triangles.push_back({to[t[0]], to[t[1]], to[t[2]]});
  return result;
}

}  // namespace

TriangleMesh closed_mesh(const scene::Wall& wall, const std::vector<NamedMesh>& meshes) {
  if (const auto* box = std::get_if<scene::BoxShape>(&wall.shape)) return box_mesh(box->size);
  if (const auto* cylinder = std::get_if<scene::CylinderShape>(&wall.shape))
    return cylinder->height
               ? cylinder_mesh(cylinder->radius, *cylinder->height, cylinder->segments.value_or(segments))
               : TriangleMesh{};
  if (const auto* sphere = std::get_if<scene::SphereShape>(&wall.shape))
    return sphere_mesh(sphere->radius, segments);
  if (std::holds_alternative<scene::MeshShape>(wall.shape))
    for (const NamedMesh& mesh : meshes)
      if (mesh.name == wall.name) return mesh.mesh;
  return {};
}

TriangleMesh surface_mesh(const scene::Wall& wall, const std::vector<NamedMesh>& meshes) {
  if (const auto* box = std::get_if<scene::BoxShape>(&wall.shape)) return box_mesh(box->size, box->open);
  if (const auto* cylinder = std::get_if<scene::CylinderShape>(&wall.shape); cylinder && cylinder->height)
    return cylinder_mesh(cylinder->radius, *cylinder->height, cylinder->segments.value_or(segments),
                         cylinder->open);
  return closed_mesh(wall, meshes);
}

bool has_open_faces(const scene::Wall& wall) {
  if (const auto* box = std::get_if<scene::BoxShape>(&wall.shape)) return !box->open.empty();
  if (const auto* cylinder = std::get_if<scene::CylinderShape>(&wall.shape)) return !cylinder->open.empty();
  return false;
}

Pose pose_of(const scene::Wall& wall, const scene::Scene& scene) {
  const Pose body = start_pose(wall.body, scene);
  return {body.p_WB + body.q_WB.rotate(wall.pose.p_WB), body.q_WB * wall.pose.q_WB};
}

TriangleMesh placed(TriangleMesh mesh, const Pose& pose, const GravityFrame& frame) {
  mesh = transformed(std::move(mesh), pose);
  for (Vec3d& vertex : mesh.vertices) vertex = frame.local(vertex);
  return mesh;
}

const scene::Wall& wall_named(const scene::Scene& scene, const std::string& name) {
  return *std::ranges::find(scene.dem->walls, name, &scene::Wall::name);
}

GravityFrame frame_of(const scene::Scene& scene, const Pose& container) {
  const double strength = norm(scene.gravity);
  const Vec3d up = strength > 0 ? (-1 / strength) * scene.gravity : Vec3d{0, 0, 1};
  Vec3d x = container.q_WB.rotate({1, 0, 0});
  if (std::abs(dot(x, up)) > 0.8) x = container.q_WB.rotate({0, 1, 0});
  x = normalized(x - dot(x, up) * up);
  const Vec3d y = cross(up, x);
  return {container.p_WB, {{{x.x, y.x, up.x}, {x.y, y.y, up.y}, {x.z, y.z, up.z}}}};
}

TriangleMesh with_closed_mouths(const TriangleMesh& given) {
  TriangleMesh mesh = joined(given);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> across;  // third corner of an open edge
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (across.erase({b, a}) == 0) across[{a, b}] = t[(k + 2) % 3];
    }
  std::map<std::uint32_t, std::uint32_t> next;
  for (const auto& [edge, corner] : across) next[edge.first] = edge.second;
  while (!next.empty()) {
    std::vector<std::uint32_t> rim;
    bool rises = true;
    for (std::uint32_t v = next.begin()->first; next.contains(v);) {
      const std::uint32_t to = next[v];
      const double high = mesh.vertices[across[{v, to}]].z;
      rises = rises && high > mesh.vertices[v].z && high > mesh.vertices[to].z;
      rim.push_back(v);
      next.erase(v);
      v = to;
    }
    if (!rises || rim.size() < 3) continue;
    Vec3d middle;
    for (const std::uint32_t v : rim) middle += mesh.vertices[v];
    const auto centre = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back((1.0 / static_cast<double>(rim.size())) * middle);
    for (std::size_t i = 0; i < rim.size(); ++i)
      mesh.triangles.push_back({rim[(i + 1) % rim.size()], rim[i], centre});
  }
  return mesh;
}

TriangleMesh hull_of(const std::vector<std::string>& names, const scene::Scene& scene,
                     const std::vector<NamedMesh>& meshes, const GravityFrame& frame,
                     const std::string& where) {
  std::vector<Vec3d> points;
  for (const std::string& name : names) {
    const scene::Wall& wall = wall_named(scene, name);
    const TriangleMesh mesh = placed(closed_mesh(wall, meshes), pose_of(wall, scene), frame);
    if (mesh.triangles.empty())
      throw Error(ErrorCode::scene, "the wall '" + name + "' does not end on all sides",
                  where + ".region.walls",
                  "name walls that end, or give a region of type 'box' or 'cylinder'");
    points.insert(points.end(), mesh.vertices.begin(), mesh.vertices.end());
  }
  std::optional<TriangleMesh> hull = convex_hull(points);
  if (!hull)
    throw Error(ErrorCode::scene, "the walls lie in one plane, and nothing is between them",
                where + ".region.walls", "name walls that have room between them");
  return std::move(*hull);
}

TriangleMesh region_mesh(const decltype(scene::PackingFill::region)& region, const GravityFrame& frame) {
  if (const auto* box = std::get_if<scene::Box>(&region))
    return placed(box_mesh(box->max - box->min), {0.5 * (box->min + box->max), {}}, frame);
  const auto& cylinder = std::get<scene::CylinderRegion>(region);
  const Vec3d axis = cylinder.to - cylinder.from, z = normalized(axis);
  // The rotation from the z axis to the axis; half a turn where they are opposite.
  const Quat q = z.z > -1 + 1e-12 ? Quat{1 + z.z, -z.y, z.x, 0}.normalized() : Quat{0, 1, 0, 0};
  return placed(cylinder_mesh(cylinder.radius, norm(axis), segments),
                {0.5 * (cylinder.from + cylinder.to), q}, frame);
}

}  // namespace tandem::particles::room
