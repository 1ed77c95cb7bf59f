#include "common/scene/model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tandem::scene {

const std::string& Scene::body_name(BodyId id) const {
  static const std::string inertial = "ground";
  return id == ground ? inertial : mbd->bodies.at(id.value).name;
}

std::vector<Wall> Scene::walls() const {
  std::vector<Wall> all = dem ? dem->walls : std::vector<Wall>{};
  if (!sph) return all;
  for (const Wall& wall : sph->walls)
    if (!dem || std::ranges::find(dem->walls, wall.name, &Wall::name) == dem->walls.end())
      all.push_back(wall);
  return all;
}

Box Scene::domain() const {
  Box all = dem ? dem->domain : sph.value().domain;
  if (!sph) return all;
  for (int a = 0; a < 3; ++a) {
    all.min[a] = std::min(all.min[a], sph->domain.min[a]);
    all.max[a] = std::max(all.max[a], sph->domain.max[a]);
  }
  return all;
}

double LiquidInlet::area() const {
  if (const auto* disc = std::get_if<DiscShape>(&shape))
    return std::numbers::pi * disc->radius * disc->radius;
  const auto& rectangle = std::get<RectangleShape>(shape);
  return rectangle.x * rectangle.y;
}

double LiquidInlet::speed() const {
  return velocity ? *velocity : flow.value() / area();
}

bool contact_is_computed(const Geometry& a, const Geometry& b) {
  const auto is_solid = [](const Geometry& g) {
    return std::holds_alternative<SphereShape>(g) || std::holds_alternative<CapsuleShape>(g) ||
           std::holds_alternative<BoxShape>(g) || std::holds_alternative<HullShape>(g);
  };
  const auto is_plane = [](const Geometry& g) { return std::holds_alternative<PlaneShape>(g); };
  const auto is_mesh = [](const Geometry& g) {
    return std::holds_alternative<MeshShape>(g) || std::holds_alternative<HeightFieldShape>(g);
  };
  const auto is_cylinder = [](const Geometry& g) { return std::holds_alternative<CylinderShape>(g); };
  const auto is_known = [&](const Geometry& g) { return is_solid(g) || is_plane(g) || is_mesh(g); };
  const auto has_faces = [&](const Geometry& g) {
    return is_plane(g) || is_mesh(g) || std::holds_alternative<BoxShape>(g) ||
           std::holds_alternative<HullShape>(g);
  };
  if (is_cylinder(a)) return has_faces(b);
  if (is_cylinder(b)) return has_faces(a);
  return is_known(a) && is_known(b) && !(is_plane(a) && is_plane(b)) && !(is_mesh(a) && is_mesh(b));
}

ContactMaterialPair combined(const BodyContact& contact, int a, int b) {
  const ContactMaterial &m = contact.materials.at(static_cast<std::size_t>(a)),
                        &o = contact.materials.at(static_cast<std::size_t>(b));
  ContactMaterialPair pair{a,
                           b,
                           {},
                           std::sqrt(m.restitution * o.restitution),
                           std::sqrt(m.friction * o.friction),
                           std::sqrt(m.rolling_friction * o.rolling_friction)};
  if (m.stiffness && o.stiffness)
    pair.stiffness = 2 * *m.stiffness * *o.stiffness / (*m.stiffness + *o.stiffness);
  for (const ContactMaterialPair& given : contact.pairs) {
    if (!((given.a == a && given.b == b) || (given.a == b && given.b == a))) continue;
    if (given.stiffness) pair.stiffness = given.stiffness;
    if (given.restitution) pair.restitution = given.restitution;
    if (given.friction) pair.friction = given.friction;
    if (given.rolling_friction) pair.rolling_friction = given.rolling_friction;
  }
  return pair;
}

DrumLead drum_lead(const Rope& rope, const std::vector<Joint>& joints) {
  const Joint& joint = joints.at(rope.drum->value);
  const Vec3d point = rope.points[0].point, axis = normalized(joint.axis),
              from_joint = point - joint.position;
  DrumLead lead;
  lead.arm = from_joint - dot(from_joint, axis) * axis;
  const double radius = norm(lead.arm);
  if (radius == 0) return lead;
  // Velocity of the surface of the drum along the rope, away from the drum, per rate and radius.
  const double pays_out = dot(normalized(rope.points[1].point - point), cross(axis, lead.arm)) / radius;
  lead.cosine = std::abs(pays_out);
  lead.per_angle = pays_out < 0 ? radius : -radius;
  return lead;
}

}  // namespace tandem::scene
