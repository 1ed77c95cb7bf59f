#include "common/scene/model.hpp"

#include <cmath>

namespace tandem::scene {

const std::string& Scene::body_name(BodyId id) const {
  static const std::string inertial = "ground";
  return id == ground ? inertial : mbd->bodies.at(id.value).name;
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
