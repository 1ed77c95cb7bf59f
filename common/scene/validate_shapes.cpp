#include <algorithm>

#include "common/scene/shape_mass.hpp"
#include "common/scene/shape_mesh.hpp"
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

// Why a shape has no volume, or empty.
std::string why_without_volume(const Geometry& geometry) {
  if (!is_bounded(geometry)) return "the " + name_of(geometry) + " is endless";
  if (const auto* box = std::get_if<BoxShape>(&geometry); box && !box->open.empty())
    return "a box with open faces is a surface";
  if (const auto* cylinder = std::get_if<CylinderShape>(&geometry); cylinder && !cylinder->open.empty())
    return "a cylinder with open ends is a surface";
  if (const auto* cone = std::get_if<ConeShape>(&geometry); cone && !cone->open.empty())
    return "a cone with open ends is a surface";
  if (const auto* field = std::get_if<HeightFieldShape>(&geometry); field && !field->base)
    return "a height field without a base is a surface";
  return {};
}

// Contact between bodies: what is not computed is refused.
void validate_contact(const Scene& scene, const std::string& origin) {
  if (!scene.contact) return;
  const BodyContact& contact = *scene.contact;
  if (contact.impacts == Impacts::within_steps && !scene.mbd->integrator.error_tolerance)
    fail(origin, "mbd.contact.impacts",
         "steps of one length do not see how hard bodies hit each other within them",
         "give mbd.integrator.error_tolerance, such as 3e-5, or leave out impacts");
  validate_time_stepping(scene, origin);
  const Mbd& mbd = *scene.mbd;
  if (!mbd.server.empty())
    fail(origin, "mbd.contact",
         "contact between bodies is computed by our own solver only, and mbd.server is another",
         "leave out mbd.contact or mbd.server");
  if (mbd.integrator.method == IntegrationMethod::dormand_prince)
    fail(origin, "mbd.integrator.method", "'dormand_prince' does not compute the contacts of mbd.contact",
         "leave out method, which is then generalized_alpha");
  if (mbd.integrator.extrapolate)
    fail(origin, "mbd.integrator.extrapolate", "contacts begin at other times in each of the two runs",
         "leave out extrapolate or mbd.contact");
  if (mbd.start == Start::equilibrium)
    fail(origin, "mbd.start", "the search for the equilibrium knows no contacts between bodies",
         "leave out start, and let the bodies come to rest in a run");
  std::vector<const Shape*> shapes;
  for (const Shape& shape : contact.ground) shapes.push_back(&shape);
  for (const Shape& shape : scene.shapes)
    if (shape.use == ShapeUse::contact) shapes.push_back(&shape);
  for (const Shape* shape : shapes) {
    require_unit(shape->pose.q_WB, origin, shape->path + ".orientation");
    const std::string at = shape->path + ".shape";
    if (const auto* plane = std::get_if<PlaneShape>(&shape->geometry))
      require_unit(plane->normal, origin, at + ".normal");
    if (const auto* box = std::get_if<BoxShape>(&shape->geometry); box && !box->open.empty())
      fail(origin, at + ".open", "a box with open faces is a surface, and contact is that of a solid",
           "leave out open");
    if (const auto* capsule = std::get_if<CapsuleShape>(&shape->geometry); capsule && capsule->segments)
      fail(origin, at + ".segments", "contact is that of the round capsule", "leave out segments");
    if (const auto* cylinder = std::get_if<CylinderShape>(&shape->geometry)) {
      if (!cylinder->height)
        fail(origin, at + ".height", "contact is that of a cylinder with two ends", "give the height");
      if (!cylinder->open.empty())
        fail(origin, at + ".open", "a cylinder with open ends is a surface, and contact is that of a solid",
             "leave out open");
      if (cylinder->segments)
        fail(origin, at + ".segments", "contact is that of the round cylinder", "leave out segments");
    }
    if (!contact_is_computed(shape->geometry, BoxShape{}))
      fail(origin, at, "contact of a " + name_of(shape->geometry) + " is not computed in this version",
           "use a sphere, a capsule, a cylinder, a box, a convex_hull, a mesh, a height_field or a plane");
  }
  const auto of = [&](const Shape& shape) {
    return "the " + name_of(shape.geometry) + " '" + shape.name + "' of '" + scene.body_name(shape.body) +
           "'";
  };
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (std::size_t k = i + 1; k < shapes.size(); ++k) {
      const Shape &a = *shapes[i], &b = *shapes[k];
      if (!may_touch(scene, a.body, b.body)) continue;
      if (!contact_is_computed(a.geometry, b.geometry))
        fail(origin, b.path + ".shape",
             "the contact of " + of(b) + " with " + of(a) + " is not computed in this version",
             "add their bodies to mbd.contact.ignore, or use other shapes: planes do not touch each other, "
             "nor do "
             "meshes and height fields, and cylinders do not touch spheres, capsules and cylinders");
      const ContactMaterialPair pair = combined(contact, a.contact_material, b.contact_material);
      const auto is_round = [](const Shape& shape) {
        return std::holds_alternative<SphereShape>(shape.geometry) ||
               std::holds_alternative<PlaneShape>(shape.geometry);
      };
      const auto& one = contact.materials[static_cast<std::size_t>(a.contact_material)];
      const auto& two = contact.materials[static_cast<std::size_t>(b.contact_material)];
      if (!pair.stiffness && (one.stiffness || two.stiffness))
        fail(origin, b.path + ".material",
             "'" + one.name + "' and '" + two.name +
                 "' touch, and one has a stiffness, the other Young's modulus",
             "give the pair a stiffness in mbd.contact.pairs");
      if (!pair.stiffness && !(is_round(a) && is_round(b)))
        fail(origin, b.path + ".material",
             "the contact of " + of(b) + " with " + of(a) + " has no curvature for Hertz's law",
             "give their materials a stiffness [N/m] in place of young and poisson");
    }
}

}  // namespace

void validate_shapes(const Scene& scene, const std::string& origin) {
  validate_contact(scene, origin);
  validate_contact_outputs(scene, origin);
  validate_roads(scene, origin);
  for (const Shape& shape : scene.shapes) {
    if (!shape.is_of_body) continue;  // checked as walls
    const Body& body = scene.mbd->bodies[shape.body.value];
    require_unit(shape.pose.q_WB, origin, shape.path + ".orientation");
    if (const auto* box = std::get_if<BoxShape>(&shape.geometry); box && box->open.size() == 6)
      fail(origin, shape.path + ".shape.open", "all six faces of the box are open", "leave a face");
    if (shape.use == ShapeUse::graphics && !is_bounded(shape.geometry))
      fail(origin, shape.path + ".shape",
           "the " + name_of(shape.geometry) + " is endless, and cannot be drawn",
           "draw a thin box or a cylinder with a height");
    if (!body.from_shapes) continue;
    if (!shape.density && !shape.material)
      fail(origin, shape.path,
           "the shape has neither density nor material, and the mass of '" + body.name +
               "' follows from its shapes",
           "add density [kg/m3]; 0 for a shape without mass");
    if (const std::string why = why_without_volume(shape.geometry);
        density_of(shape, scene) > 0 && !why.empty())
      fail(origin, shape.path + ".shape", why + ", and has no volume for a mass", "give \"density\": 0");
  }
  if (!scene.mbd) return;
  for (std::uint32_t b = 0; b < scene.mbd->bodies.size(); ++b) {
    if (!scene.mbd->bodies[b].from_shapes) continue;
    const bool has_mass = std::any_of(scene.shapes.begin(), scene.shapes.end(), [&](const Shape& shape) {
      return shape.is_of_body && shape.body == BodyId{b} && density_of(shape, scene) > 0;
    });
    if (!has_mass)
      fail(origin, element("mbd.bodies", b) + ".mass", "all shapes have the density 0",
           "give one of them a density");
  }
}

}  // namespace tandem::scene
