#include "common/scene/plain_text.hpp"

#include <nlohmann/json.hpp>

#include "common/scene/document.hpp"
#include "common/scene/fault.hpp"
#include "common/scene/plain_form.hpp"
#include "common/scene/shape_mesh.hpp"

namespace tandem::scene {

namespace {

using nlohmann::json;

json numbers(Vec3d v) {
  return json::array({v.x, v.y, v.z});
}
json numbers(Quat q) {
  return json::array({q.w, q.x, q.y, q.z});
}

// The entry of dem.walls, or of sph.walls, for a shape that stands in the file as `source`.
json wall_entry(const Shape& shape, const json& source, const Scene& scene, bool moved, bool of_liquid) {
  json wall = shape.is_of_body ? json::object() : source;
  if (shape.is_of_body) {
    for (const char* key : {"name", "shape"}) wall[key] = source.at(key);
    if (!of_liquid) wall["material"] = source.at("material");
    wall["body"] = scene.body_name(shape.body);
  }
  if (shape.is_of_body || moved) {
    wall["position"] = numbers(shape.pose.p_WB);
    wall["orientation"] = numbers(shape.pose.q_WB);
  }
  if (is_made_of_facets(shape.geometry))
    wall["shape"] = {{"type", "mesh"}, {"file", std::get<MeshShape>(wall_of(shape).shape).file}};
  return wall;
}

// The shape of a body that touches others, of which the solver needs no density.
json contact_entry(const Shape& shape, const json& source) {
  json entry = source;
  entry.erase("density");
  entry["position"] = numbers(shape.pose.p_WB);
  entry["orientation"] = numbers(shape.pose.q_WB);
  return entry;
}

}  // namespace

std::string plain_text(const std::string& text, const Scene& scene, const std::string& origin) {
  json document = read_document(text, origin);
  to_plain_form(document, origin);

  // The shapes as they stand in the file, in the order of scene.shapes, and whether their body has moved to
  // its centre of mass.
  std::vector<json> sources;
  std::vector<bool> shaped(scene.mbd ? scene.mbd->bodies.size() : 0);
  if (scene.dem && document["dem"].contains("walls"))
    for (const json& wall : document["dem"]["walls"]) sources.push_back(wall);
  if (scene.sph && document["sph"].contains("walls"))
    for (const json& wall : document["sph"]["walls"]) sources.push_back(wall);
  for (std::size_t b = 0; b < shaped.size(); ++b) {
    json& body = document["mbd"]["bodies"][b];
    shaped[b] = body["mass"].is_string();
    if (shaped[b]) {
      body["mass"] = scene.mbd->bodies[b].mass;
      body["inertia"] = scene.mbd->bodies[b].inertia;
      body["position"] = numbers(scene.mbd->bodies[b].pose.p_WB);
    }
    if (!body.contains("shapes")) continue;
    for (const json& shape : body["shapes"]) sources.push_back(shape);
    body.erase("shapes");
  }

  json of_grains = json::array(), of_liquid = json::array();
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    const Shape& shape = scene.shapes[i];
    if (shape.use != ShapeUse::wall) continue;
    const bool moved = shape.body != ground && shaped[shape.body.value];
    if (scene.dem && shape.for_grains)
      of_grains.push_back(wall_entry(shape, sources.at(i), scene, moved, false));
    if (scene.sph && shape.for_liquid)
      of_liquid.push_back(wall_entry(shape, sources.at(i), scene, moved, true));
  }
  if (!of_grains.empty()) document["dem"]["walls"] = std::move(of_grains);
  if (!of_liquid.empty()) document["sph"]["walls"] = std::move(of_liquid);
  const auto move_sensor = [&](const ParticleSensor& sensor, json& entry) {
    if (sensor.body != ground && shaped[sensor.body.value]) entry["position"] = numbers(sensor.pose.p_WB);
  };
  for (std::size_t i = 0; scene.dem && i < scene.dem->sensors.size(); ++i)
    move_sensor(scene.dem->sensors[i], document["dem"]["sensors"][i]);
  for (std::size_t i = 0; scene.sph && i < scene.sph->sensors.size(); ++i)
    move_sensor(scene.sph->sensors[i], document["sph"]["sensors"][i]);
  for (std::size_t i = 0; i < scene.shapes.size(); ++i)
    if (const Shape& shape = scene.shapes[i]; shape.use == ShapeUse::contact)
      document["mbd"]["bodies"][shape.body.value]["shapes"].push_back(contact_entry(shape, sources.at(i)));
  return document.dump(2);
}

void expect_masses(const Scene& scene, const std::string& origin) {
  if (!scene.mbd) return;
  for (std::size_t b = 0; b < scene.mbd->bodies.size(); ++b)
    if (scene.mbd->bodies[b].from_shapes)
      fail(origin, element("mbd.bodies", b) + ".mass",
           "the mass of '" + scene.mbd->bodies[b].name +
               "' follows from its shapes, which this program does not do",
           "send the scene in the plain form, as tandem does");
}

}  // namespace tandem::scene
