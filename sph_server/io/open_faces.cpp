#include "sph_server/io/open_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "particles/geometry/touch_facet.hpp"
#include "particles/serving/boundary.hpp"
#include "sph_server/io/points.hpp"

namespace tandem::sph {
namespace {

// Faces that a box or a cylinder leaves open, and half its size.
struct Opened {
  std::vector<std::string> faces;
  Vec3d half;  // [m]
};
Opened opened(const decltype(scene::Wall::shape)& shape) {
  if (const auto* box = std::get_if<scene::BoxShape>(&shape)) return {box->open, 0.5 * box->size};
  if (const auto* cylinder = std::get_if<scene::CylinderShape>(&shape))
    return {cylinder->open, {0, 0, 0.5 * cylinder->height.value()}};
  return {};
}

bool is_near(const Walls& walls, Vec3d x, double distance) {
  NearWalls near;
  walls.find(x, distance, near);
  for (int k = 0; k < near.count; ++k) {
    const NearFacet& f = near.facet[k];
    particles::WallContact contact;
    if (particles::touch_triangle({f.a, f.b, f.c, f.normal}, x, distance, contact)) return true;
  }
  return false;
}

}  // namespace

std::optional<OpenFace> open_face(const scene::Wall& wall, const scene::Scene& scene,
                                  const std::vector<NamedMesh>& meshes, const Walls& walls, Vec3d up,
                                  double level) {
  const auto [faces, half] = opened(wall.shape);
  if (faces.empty()) return std::nullopt;
  const scene::Sph& sph = scene.sph.value();
  const particles::BodyPose body = particles::pose_at_start(wall.body, scene);
  const TriangleMesh whole = whole_mesh_of(wall, sph, meshes);  // in the frame of the body
  for (const std::string& face : faces) {
    const int axis = face[1] - 'x';
    Vec3d outwards;
    outwards[axis] = face[0] == '+' ? 1 : -1;
    const Vec3d normal = wall.pose.q_WB.rotate(outwards);
    const double height = dot(wall.pose.p_WB, normal) + half[axis];
    std::optional<Vec3d> gap;
    for (const auto& t : whole.triangles) {
      Vec3d corner[3];
      bool in_face = true;
      for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = whole.vertices[t[k]];
        in_face = in_face && std::fabs(dot(corner[k], normal) - height) < 1e-9 * (1 + half[axis]);
        corner[k] = body.p + body.R * corner[k];
      }
      if (!in_face) continue;
      for_points(corner[0], corner[1], corner[2], sph.spacing, [&](Vec3d x) {
        if (!gap && dot(x, up) < level && !is_near(walls, x, 0.5 * sph.spacing)) gap = x;
      });
    }
    if (gap) return OpenFace{face, *gap};
  }
  return std::nullopt;
}

std::vector<std::string> open_faces(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                                    const std::vector<FilledInside>& insides, const LiquidSetup& setup,
                                    const std::vector<particles::BodyPose>& poses) {
  std::vector<std::string> sentences;
  if (insides.empty()) return sentences;
  const scene::Sph& sph = scene.sph.value();
  const Vec3d up = -1.0 / norm(scene.gravity) * scene.gravity;
  Walls walls(setup.walls, setup.liquid.support());
  for (std::uint32_t b = 0; b < walls.bodies(); ++b) walls.set_pose(b, poses[b]);
  for (const FilledInside& filled : insides) {
    const auto& fill = std::get<scene::LiquidInside>(sph.liquids.front().fill[filled.fill]);
    const scene::Wall& wall = *std::ranges::find(sph.walls, fill.wall, &scene::Wall::name);
    double low = std::numeric_limits<double>::infinity();
    for (const Vec3d& v : filled.region.vertices) low = std::min(low, dot(v, up));
    if (const auto open = open_face(wall, scene, meshes, walls, up, low + filled.depth))
      sentences.push_back(fmt::format(
          "{}: wall '{}' is open at {} below the level, and no wall is within half a spacing of {} m: the "
          "liquid flows out there. Close the face, give a lower level, or put a wall there",
          place_of_fill(filled.fill), wall.name, open->face, scene::rounded(open->at)));
  }
  return sentences;
}

}  // namespace tandem::sph
