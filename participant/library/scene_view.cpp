#include "participant/library/scene_view.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/scene/columns.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/force_parts.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/plain_text.hpp"
#include "particles/io/fill.hpp"

namespace tandem::participant {
namespace {

tandem_pose view(const Pose& pose) {
  const auto& [p, q] = pose;
  return {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

tandem_twist view(const Twist& twist) {
  const auto& [v, w] = twist;
  return {{v.x, v.y, v.z}, {w.x, w.y, w.z}};
}

void put(double (&to)[3], Vec3d from) {
  to[0] = from.x, to[1] = from.y, to[2] = from.z;
}

void append(std::vector<double>& list, Vec3d v) {
  list.insert(list.end(), {v.x, v.y, v.z});
}

// Text of `solver_options` in this part of the scene.
std::string solver_options(const std::string& scene, const char* part) {
  const auto json = nlohmann::ordered_json::parse(scene);
  const auto found = json.find(part);
  if (found == json.end() || !found->contains("solver_options")) return "{}";
  return found->at("solver_options").dump();
}

// The triangles of a wall in its body's frame; none for smooth shapes.
TriangleMesh triangles_of(const scene::Wall& wall, const std::vector<protocol::NamedMesh>& meshes) {
  if (const auto* box = std::get_if<scene::BoxShape>(&wall.shape))
    return transformed(box_mesh(box->size, box->open), wall.pose);
  if (std::holds_alternative<scene::MeshShape>(wall.shape)) {
    const auto named = std::ranges::find(meshes, wall.name, &protocol::NamedMesh::name);
    if (named == meshes.end())
      throw Error(ErrorCode::protocol, "no mesh came with it", "wall '" + wall.name + "'");
    return transformed(named->mesh, wall.pose);
  }
  if (const auto* cylinder = std::get_if<scene::CylinderShape>(&wall.shape); cylinder && cylinder->segments)
    return transformed(
        cylinder_mesh(cylinder->radius, cylinder->height.value(), *cylinder->segments, cylinder->open),
        wall.pose);
  return {};
}

}  // namespace

SceneView::SceneView(const protocol::Configuration& configuration, protocol::Role role)
    : scene_(scene::parse(configuration.scene_text, configuration.origin)) {
  scene::expect_masses(scene_, configuration.origin);
  view_.scene = kept(configuration.scene_text);
  view_.origin = kept(configuration.origin);
  view_.solver_options = kept(solver_options(configuration.scene_text, protocol::word_of(role)));
  view_.backend = kept(configuration.backend);
  view_.threads = configuration.threads;
  put(view_.gravity, scene_.gravity);
  view_.end_time = scene_.end_time;
  view_.window = scene_.coupling.window;
  if (scene_.mbd) view_bodies();
  if (role == protocol::Role::sph) {
    if (scene_.sph) view_liquid(configuration.meshes);
  } else if (scene_.dem) {
    view_grains(configuration.meshes);
    if (role == protocol::Role::dem) view_spheres(configuration.files);
  }
}

const char* SceneView::kept(const std::string& text) {
  return texts_.emplace_back(text).c_str();
}

void SceneView::view_bodies() {
  const scene::Mbd& mbd = *scene_.mbd;
  std::vector<bool> bound(mbd.bodies.size());
  const auto bind = [&](BodyId body) {
    if (body != ground) bound[body.value] = true;
  };
  for (const scene::Joint& joint : mbd.joints) bind(joint.parent), bind(joint.child);
  for (const BodyId body : scene::attached_to(mbd).bodies) bind(body);
  for (std::uint32_t b = 0; b < mbd.bodies.size(); ++b) {
    const scene::Body& body = mbd.bodies[b];
    const auto& [xx, yy, zz, xy, xz, yz] = body.inertia;
    const bool walls =
        std::ranges::any_of(scene_.walls(), [&](const scene::Wall& wall) { return wall.body == BodyId{b}; });
    bodies_.push_back({kept(body.name),
                       body.mass,
                       {xx, xy, xz, xy, yy, yz, xz, yz, zz},
                       view(body.pose),
                       view(body.twist),
                       walls,
                       !bound[b]});
    if (walls) boundary_.push_back(b);
  }
  view_.body_count = bodies_.size();
  view_.bodies = bodies_.data();
  view_.joint_count = mbd.joints.size();
  view_.boundary_count = boundary_.size();
  view_.boundary = boundary_.data();
  view_.control_count = scene::control_inputs(mbd).size();
  for (const std::string& column : scene::element_columns(scene_)) element_columns_.push_back(kept(column));
  view_.element_count = element_columns_.size();
  view_.element_columns = element_columns_.data();
}

void SceneView::view_grains(const std::vector<protocol::NamedMesh>& meshes) {
  const scene::Dem& dem = *scene_.dem;
  for (const scene::Material& material : dem.materials)
    materials_.push_back({kept(material.name), material.density, material.young, material.poisson});
  for (const scene::Pair& pair : dem.pairs)
    pairs_.push_back({.a = pair.a.value,
                      .b = pair.b.value,
                      .restitution = pair.restitution,
                      .friction = pair.friction,
                      .rolling_friction = pair.rolling_friction,
                      .rolling_damping = pair.rolling_damping,
                      .spring_stiffness = pair.spring_stiffness,
                      .spring_ratio = pair.spring_ratio,
                      .work_of_adhesion = pair.work_of_adhesion,
                      .cohesion_energy_density = pair.cohesion_energy_density,
                      .normal_stiffness = pair.normal_stiffness,
                      .normal_damping = pair.normal_damping,
                      .tangential_stiffness = pair.tangential_stiffness,
                      .tangential_damping = pair.tangential_damping});
  view_.material_count = materials_.size();
  view_.materials = materials_.data();
  view_.pair_count = pairs_.size();
  view_.pairs = pairs_.data();
  view_walls(dem.walls, meshes);
  set_domain(dem.micro_step, dem.domain);
}

void SceneView::view_liquid(const std::vector<protocol::NamedMesh>& meshes) {
  const scene::Sph& sph = *scene_.sph;
  for (const scene::Liquid& liquid : sph.liquids) {
    std::vector<double>& boxes = boxes_.emplace_back();
    for (const auto& fill : liquid.fill)
      if (const auto* box = std::get_if<scene::Box>(&fill)) append(boxes, box->min), append(boxes, box->max);
    tandem_liquid& seen = liquids_.emplace_back();
    seen.name = kept(liquid.name);
    seen.density = liquid.density;
    seen.viscosity = liquid.viscosity;
    seen.sound_speed = liquid.sound_speed.value_or(0);
    put(seen.velocity, liquid.velocity.value_or(Vec3d{}));
    seen.hydrostatic = liquid.pressure == scene::StartPressure::hydrostatic;
    seen.box_count = boxes.size() / 6;
    seen.boxes = boxes.data();
  }
  view_.spacing = sph.spacing;
  view_.liquid_count = liquids_.size();
  view_.liquids = liquids_.data();
  view_walls(sph.walls, meshes);
  // What presses on an inlet is a load on the ground.
  if (!sph.inlets.empty()) ground_has_walls_ = true;
  set_domain(sph.micro_step, sph.domain);
}

void SceneView::set_domain(const std::optional<double>& micro_step, const scene::Box& domain) {
  view_.micro_step = micro_step.value_or(0);
  put(view_.domain_min, domain.min);
  put(view_.domain_max, domain.max);
}

void SceneView::view_walls(const std::vector<scene::Wall>& walls,
                           const std::vector<protocol::NamedMesh>& meshes) {
  for (const scene::Wall& wall : walls) {
    if (wall.body == ground) ground_has_walls_ = true;
    tandem_wall& seen = walls_.emplace_back();
    seen.name = kept(wall.name);
    seen.body = wall.body.value;
    seen.material = wall.material.value;
    seen.pose = view(wall.pose);
    seen.shape = TANDEM_WALL_MESH;
    std::vector<double>& corners = triangles_.emplace_back();
    const TriangleMesh mesh = triangles_of(wall, meshes);
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t vertex : triangle) append(corners, mesh.vertices[vertex]);
    seen.triangle_count = mesh.triangles.size();
    seen.triangles = corners.data();
    if (const auto* plane = std::get_if<scene::PlaneShape>(&wall.shape)) {
      seen.shape = TANDEM_WALL_PLANE;
      put(seen.point, wall.pose.p_WB + wall.pose.q_WB.rotate(plane->point));
      put(seen.normal, normalized(wall.pose.q_WB.rotate(plane->normal)));
    } else if (const auto* cylinder = std::get_if<scene::CylinderShape>(&wall.shape)) {
      if (!cylinder->segments) seen.shape = TANDEM_WALL_CYLINDER;
      seen.radius = cylinder->radius;
      seen.height = cylinder->height.value_or(std::numeric_limits<double>::infinity());
      for (const std::string& end : cylinder->open) seen.open |= end == "-z" ? 1u : 2u;
    } else if (const auto* sphere = std::get_if<scene::SphereShape>(&wall.shape)) {
      seen.shape = TANDEM_WALL_SPHERE;
      seen.radius = sphere->radius;
    }
  }
  view_.wall_count = walls_.size();
  view_.walls = walls_.data();
}

void SceneView::view_spheres(const std::vector<protocol::NamedText>& files) {
  std::vector<particles::NamedParticles> read;
  read.reserve(files.size());
  for (const protocol::NamedText& file : files)
    read.push_back({file.name, scene::read_particle_file(file.text, file.name)});
  const particles::Fill fill = particles::make_fill(scene_, read);
  for (const Vec3d& p : fill.position) append(position_, p);
  for (const Vec3d& v : fill.velocity) append(velocity_, v);
  for (const Vec3d& w : fill.spin) append(spin_, w);
  const auto spins = std::ranges::find_if(fill.spin, [](Vec3d w) { return w != Vec3d{}; });
  if (spins != fill.spin.end())
    spinning_group_ = scene_.dem->particles[fill.group[spins - fill.spin.begin()]].name;
  radius_ = fill.radius;
  sphere_material_ = fill.material;
  view_.sphere_count = radius_.size();
  view_.sphere_position = position_.data();
  view_.sphere_velocity = velocity_.data();
  view_.sphere_spin = spin_.data();
  view_.sphere_radius = radius_.data();
  view_.sphere_material = sphere_material_.data();
}

protocol::BodyMotion SceneView::start_of(std::uint32_t index) const {
  const scene::Body& body = scene_.mbd->bodies[index];
  protocol::BodyMotion motion;
  motion.body = index;
  motion.begin_pose = motion.end_pose = body.pose;
  motion.begin_twist = motion.end_twist = body.twist;
  return motion;
}

}  // namespace tandem::participant
