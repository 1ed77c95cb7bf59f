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
  if (const auto* field = std::get_if<HeightFieldShape>(&geometry); field && !field->base)
    return "a height field without a base is a surface";
  return {};
}

}  // namespace

void validate_shapes(const Scene& scene, const std::string& origin) {
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
