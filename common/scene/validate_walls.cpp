#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/validate_parts.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

namespace {

// A triangle of a wall, or an infinite plane, in the frame of the wall's body. Meshes from files have none
// here.
struct Face {
  Vec3d normal;       // unit, out of the solid [-]
  double offset = 0;  // of its plane along the normal [m]
  bool infinite = false;
  Vec3d corners[3];  // [m]
};

std::vector<Face> faces_of(const TriangleMesh& mesh, const Pose& pose) {
  const TriangleMesh placed = transformed(mesh, pose);
  std::vector<Face> faces;
  for (const auto& [i, j, k] : placed.triangles) {
    const Vec3d a = placed.vertices[i], b = placed.vertices[j], c = placed.vertices[k];
    const Vec3d normal = normalized(cross(b - a, c - a));
    faces.push_back({.normal = normal, .offset = dot(normal, a), .infinite = false, .corners = {a, b, c}});
  }
  return faces;
}

std::vector<Face> faces_of(const Wall& wall) {
  if (const auto* plane = std::get_if<PlaneShape>(&wall.shape)) {
    const Vec3d normal = wall.pose.q_WB.rotate(plane->normal);
    const Vec3d point = wall.pose.p_WB + wall.pose.q_WB.rotate(plane->point);
    return {{.normal = normal, .offset = dot(normal, point), .infinite = true, .corners = {}}};
  }
  if (const auto* box = std::get_if<BoxShape>(&wall.shape))
    return faces_of(box_mesh(box->size, box->open), wall.pose);
  // The sides of round cylinders are compared as such; the flat ends are drawn finely.
  if (const auto* cylinder = std::get_if<CylinderShape>(&wall.shape); cylinder && cylinder->height)
    return faces_of(
        cylinder_mesh(cylinder->radius, *cylinder->height, cylinder->segments.value_or(96), cylinder->open),
        wall.pose);
  return {};
}

// Whether two walls are one round surface, in whole or in part: the same sphere, or cylinders with one axis
// and radius.
bool overlap(const SphereShape& a, const Pose& pose_a, const SphereShape& b, const Pose& pose_b) {
  return a.radius == b.radius && norm(pose_a.p_WB - pose_b.p_WB) <= 1e-9 * a.radius;
}
bool overlap(const CylinderShape& a, const Pose& pose_a, const CylinderShape& b, const Pose& pose_b) {
  if (a.segments || b.segments || std::abs(a.radius - b.radius) > 1e-9 * a.radius) return false;
  const Vec3d axis = pose_a.q_WB.rotate({0, 0, 1}), other = pose_b.q_WB.rotate({0, 0, 1});
  const Vec3d apart = pose_b.p_WB - pose_a.p_WB;
  if (norm(cross(axis, other)) > 1e-9 || norm(cross(axis, apart)) > 1e-9 * a.radius) return false;
  constexpr double endless = std::numeric_limits<double>::infinity();
  const double reach = 0.5 * a.height.value_or(endless) + 0.5 * b.height.value_or(endless);
  return std::abs(dot(axis, apart)) < reach - 1e-9 * a.radius;
}

// Two triangles in one plane have a common area unless an edge of one separates them (separating axis
// theorem).
bool share_area(const Face& a, const Face& b, double rounding) {
  for (const Face* face : {&a, &b})
    for (int i = 0; i < 3; ++i) {
      const Vec3d across = normalized(cross(face->normal, face->corners[(i + 1) % 3] - face->corners[i]));
      const auto range = [&](const Face& f) {
        const double p = dot(across, f.corners[0]), q = dot(across, f.corners[1]),
                     r = dot(across, f.corners[2]);
        return std::pair{std::min({p, q, r}), std::max({p, q, r})};
      };
      const auto [a_min, a_max] = range(a);
      const auto [b_min, b_max] = range(b);
      if (a_max <= b_min + rounding || b_max <= a_min + rounding) return false;
    }
  return true;
}

// Only faces with the same normal count: the faces of two adjacent bricks have opposite normals, and no
// sphere can get between them.
bool overlap(const Face& a, const Face& b) {
  constexpr double relative = 1e-9;
  if (dot(a.normal, b.normal) < 1 - relative) return false;
  double size = std::fmax(std::abs(a.offset), std::abs(b.offset));
  for (const Face* face : {&a, &b})
    for (const Vec3d& corner : face->corners) size = std::fmax(size, norm(corner));
  if (std::abs(a.offset - b.offset) > relative * size) return false;
  return a.infinite || b.infinite || share_area(a, b, relative * size);
}

// by_faces: flat faces count as well.
bool overlap(const Wall& a, const Wall& b, bool by_faces) {
  if (a.body != b.body) return false;
  const auto* mesh_a = std::get_if<MeshShape>(&a.shape);
  const auto* mesh_b = std::get_if<MeshShape>(&b.shape);
  if (mesh_a && mesh_b)
    return mesh_a->file == mesh_b->file && mesh_a->scale == mesh_b->scale &&
           mesh_a->stretch == mesh_b->stretch && a.pose.p_WB == b.pose.p_WB && a.pose.q_WB == b.pose.q_WB;
  const auto* sphere_a = std::get_if<SphereShape>(&a.shape);
  const auto* sphere_b = std::get_if<SphereShape>(&b.shape);
  if (sphere_a && sphere_b) return overlap(*sphere_a, a.pose, *sphere_b, b.pose);
  const auto* cylinder_a = std::get_if<CylinderShape>(&a.shape);
  const auto* cylinder_b = std::get_if<CylinderShape>(&b.shape);
  if (cylinder_a && cylinder_b && overlap(*cylinder_a, a.pose, *cylinder_b, b.pose)) return true;
  if (!by_faces) return false;
  const std::vector<Face> faces_a = faces_of(a), faces_b = faces_of(b);
  for (const Face& face_a : faces_a)
    for (const Face& face_b : faces_b)
      if (overlap(face_a, face_b)) return true;
  return false;
}

std::string path_of(const Wall& wall, std::size_t index, const char* list = "dem.walls") {
  return wall.path.empty() ? element(list, index) : wall.path;
}

// What holds for walls of grains and of a liquid. `list`: their place in the scene, `touch`: what touches
// them, `by_faces`: faces of two walls must not lie on each other.
void validate_surfaces(const std::vector<Wall>& walls, const char* list, const char* touch, bool by_faces,
                       const Scene& scene, const std::string& origin) {
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const std::string path = path_of(walls[i], i, list);
    require_unit(walls[i].pose.q_WB, origin, path + ".orientation");
    if (const auto* plane = std::get_if<PlaneShape>(&walls[i].shape))
      require_unit(plane->normal, origin, path + ".shape.normal");
    if (const auto* box = std::get_if<BoxShape>(&walls[i].shape); box && box->open.size() == 6)
      fail(origin, path + ".shape.open", "all six faces of the box are open",
           "leave a face, or leave out the wall");
    if (const auto* cylinder = std::get_if<CylinderShape>(&walls[i].shape); cylinder && !cylinder->height)
      for (const bool segments : {true, false})
        if (segments ? cylinder->segments.has_value() : !cylinder->open.empty())
          fail(origin, path + (segments ? ".shape.segments" : ".shape.open"),
               std::string("a cylinder without a height is endless: it has no ") +
                   (segments ? "flat faces" : "ends"),
               "give a height, or leave this out");
  }
  for (std::size_t i = 0; i < walls.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (overlap(walls[k], walls[i], by_faces))
        fail(origin, path_of(walls[i], i, list),
             "wall '" + walls[i].name + "' overlaps wall '" + walls[k].name + "' on '" +
                 scene.body_name(walls[i].body) + "'",
             std::string("which of them ") + touch + " is left to chance: move one, or leave it out");
}

}  // namespace

void validate_liquid_walls(const Scene& scene, const std::string& origin) {
  const std::vector<Wall>& walls = scene.sph->walls;
  // A block may stand on a floor: the solver knows which faces the liquid sees.
  validate_surfaces(walls, "sph.walls", "the liquid touches", false, scene, origin);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const std::string path = path_of(walls[i], i, "sph.walls");
    if (std::holds_alternative<PlaneShape>(walls[i].shape) && walls[i].body != ground)
      fail(origin, path + ".shape",
           "the plane is on a body that moves, and the liquid knows no endless walls there",
           "give a face of a box: a box with five open faces");
    if (const auto* cylinder = std::get_if<CylinderShape>(&walls[i].shape); cylinder && !cylinder->height)
      fail(origin, path + ".shape", "the cylinder is endless, and the liquid knows no such wall",
           "give it a height");
  }
}

void validate_walls(const Scene& scene, const std::string& origin) {
  const std::vector<Wall>& walls = scene.dem->walls;
  validate_surfaces(walls, "dem.walls", "spheres touch", true, scene, origin);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const std::string path = path_of(walls[i], i);
    if (const auto& surface = walls[i].surface_velocity) {
      if (scene.dem->contact == ContactLaw::hertz_frictionless)
        fail(origin, path + ".surface_velocity",
             "the law hertz_frictionless has no friction, so that a belt moves nothing",
             "choose a contact law with friction, or leave it out");
      require_unit(surface->direction, origin, path + ".surface_velocity.direction");
      validate_size(surface->speed, origin, path + ".surface_velocity.speed");
      if (const auto* plane = std::get_if<PlaneShape>(&walls[i].shape)) {
        const Vec3d normal = walls[i].pose.q_WB.rotate(plane->normal);
        constexpr double rounding = 1e-6;
        if (const double out = dot(surface->direction, normal); std::abs(out) > rounding)
          fail(origin, path + ".surface_velocity",
               "the velocity has a share of " + text(out) + " along the normal of the plane, " + text(normal),
               "a surface moves along itself: give a velocity in the plane, or move the body");
      }
    }
  }
}

void validate_moving_domain(const Scene& scene, const std::string& origin) {
  const Dem& dem = *scene.dem;
  const BodyId followed = *dem.follows;
  const std::string path = "dem.domain.follows", name = "'" + scene.body_name(followed) + "'";
  for (const bool periodic : dem.periodic)
    if (periodic)
      fail(origin, path, "a periodic domain cannot follow a body", "leave out periodic or follows");
  const auto is_on_followed = [&](const Wall& wall) { return wall.body == followed; };
  if (std::none_of(dem.walls.begin(), dem.walls.end(), is_on_followed))
    fail(origin, path, "the body " + name + " carries no wall",
         "the particles know where bodies with walls are: name one of those");
  for (std::size_t i = 0; i < dem.walls.size(); ++i) {
    const Wall& wall = dem.walls[i];
    const auto* cylinder = std::get_if<CylinderShape>(&wall.shape);
    const bool endless = std::holds_alternative<PlaneShape>(wall.shape) || (cylinder && !cylinder->height);
    // The speed of the wall's farthest point near spheres would be unknown.
    if (endless && wall.body != ground && wall.body != followed)
      fail(origin, path_of(wall, i),
           "the wall '" + wall.name + "' is endless, on a body that the domain does not follow",
           "give it an end, fix it to the ground or to " + name + ", or leave out dem.domain.follows");
  }
}

const Wall& require_wall(const std::string& name, const std::vector<Wall>& walls, const std::string& origin,
                         const std::string& path) {
  const auto found = std::ranges::find(walls, name, &Wall::name);
  if (found != walls.end()) return *found;
  std::vector<std::string> names;
  for (const Wall& wall : walls) names.push_back(wall.name);
  fail(origin, path, "there is no wall '" + shortened(name) + "'",
       names.empty() ? "the scene has no walls" : suggest_name(name, names, "walls"));
}

void validate_dissipation(const Scene& scene, const std::string& origin) {
  if (!scene.output.dissipation) return;
  const std::string path = "output.dissipation";
  if (!scene.dem) fail(origin, path, "is of contacts of spheres, and the scene has none", "leave it out");
  const ContactLaw law = scene.dem->contact;
  if (law != ContactLaw::hertz_mindlin && law != ContactLaw::hertz_frictionless && law != ContactLaw::hooke)
    fail(origin, path,
         "the contact law of the scene does not tell what its dampers or its adhesion dissipate",
         "leave it out, or choose hertz_mindlin, hertz_frictionless or hooke");
}

namespace {

// For what frames have of the spheres; `what` says what it is: "are loads of spheres".
void require_spheres_in_frames(const Scene& scene, const std::string& origin, const std::string& path,
                               const std::string& what) {
  if (!scene.dem) fail(origin, path, what + ", and the scene has none", "leave it out");
  if (!scene.output.particles)
    fail(origin, path, "come with the spheres in frames, and frames of this scene have none",
         "leave it out, or write \"particles\": true");
}

}  // namespace

void validate_body_contacts(const Scene& scene, const std::string& origin) {
  if (scene.output.contacts.empty()) return;
  require_spheres_in_frames(scene, origin, "output.contacts", "are contacts with spheres");
  for (std::size_t i = 0; i < scene.output.contacts.size(); ++i) {
    const BodyId body = scene.output.contacts[i];
    const auto is_on_it = [&](const Wall& wall) { return wall.body == body; };
    if (std::ranges::none_of(scene.dem->walls, is_on_it))
      fail(origin, element("output.contacts", i),
           "the body '" + scene.body_name(body) + "' carries no wall, so that spheres pass through it",
           "leave it out, or give it a wall");
  }
}

// A plane and a round wall are one surface for the contacts: what they have on each of their triangles in a
// picture is not known.
void validate_wall_fields(const Scene& scene, const std::string& origin) {
  if (scene.output.wall_fields.empty()) return;
  require_spheres_in_frames(scene, origin, "output.wall_fields", "are loads of spheres");
  const Dem& dem = *scene.dem;
  for (std::size_t i = 0; i < scene.output.wall_fields.size(); ++i) {
    const std::string path = element("output.wall_fields", i);
    const Wall& wall = require_wall(scene.output.wall_fields[i], dem.walls, origin, path);
    const auto* cylinder = std::get_if<CylinderShape>(&wall.shape);
    if (cylinder ? !cylinder->segments
                 : std::holds_alternative<PlaneShape>(wall.shape) ||
                       std::holds_alternative<SphereShape>(wall.shape))
      fail(origin, path,
           "the wall '" + wall.name + "' is " +
               (cylinder                                         ? "a round cylinder"
                : std::holds_alternative<PlaneShape>(wall.shape) ? "a plane"
                                                                 : "a sphere") +
               ", one surface without triangles",
           cylinder && cylinder->height ? "give its shape 'segments'" : "give a box or a mesh");
    if (dem.materials[wall.material.value].hardness) continue;
    for (const Pair& pair : dem.pairs)
      if (pair.wear_coefficient > 0 && (pair.a == wall.material || pair.b == wall.material))
        fail(origin, path,
             "the material '" + dem.materials[wall.material.value].name + "' of the wall '" + wall.name +
                 "' wears, with a wear_coefficient of " + text(pair.wear_coefficient) +
                 ", and has no hardness",
             "give the material 'hardness' [Pa], or leave the wear_coefficient out");
  }
}

}  // namespace tandem::scene
