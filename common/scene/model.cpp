#include "common/scene/model.hpp"

#include <cmath>

namespace tandem::scene {

const std::string& Scene::body_name(BodyId id) const {
  static const std::string inertial = "ground";
  return id == ground ? inertial : mbd->bodies.at(id.value).name;
}

namespace {

bool is_plane(const Geometry& g) {
  return std::holds_alternative<PlaneShape>(g);
}
bool is_sphere(const Geometry& g) {
  return std::holds_alternative<SphereShape>(g);
}
bool has_corners_or_is_round(const Geometry& g) {
  return is_sphere(g) || std::holds_alternative<CapsuleShape>(g) || std::holds_alternative<BoxShape>(g) ||
         std::holds_alternative<HullShape>(g);
}

}  // namespace

bool contact_is_computed(const Geometry& a, const Geometry& b) {
  if (is_plane(a) || is_plane(b)) return has_corners_or_is_round(is_plane(a) ? b : a);
  const auto beside_sphere = [](const Geometry& g) {
    return is_sphere(g) || std::holds_alternative<CapsuleShape>(g) || std::holds_alternative<BoxShape>(g);
  };
  return (is_sphere(a) && beside_sphere(b)) || (is_sphere(b) && beside_sphere(a));
}

ContactMaterialPair combined(const BodyContact& contact, int a, int b) {
  const ContactMaterial &m = contact.materials.at(static_cast<std::size_t>(a)),
                        &o = contact.materials.at(static_cast<std::size_t>(b));
  ContactMaterialPair pair{a, b, {}, std::sqrt(m.restitution * o.restitution), std::sqrt(m.friction * o.friction)};
  if (m.stiffness && o.stiffness)
    pair.stiffness = 2 * *m.stiffness * *o.stiffness / (*m.stiffness + *o.stiffness);
  for (const ContactMaterialPair& given : contact.pairs) {
    if (!((given.a == a && given.b == b) || (given.a == b && given.b == a))) continue;
    if (given.stiffness) pair.stiffness = given.stiffness;
    if (given.restitution) pair.restitution = given.restitution;
    if (given.friction) pair.friction = given.friction;
  }
  return pair;
}

}  // namespace tandem::scene
