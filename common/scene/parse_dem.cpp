#include "common/scene/parse_parts.hpp"

namespace tandem::scene {

namespace {

ContactLaw contact_law(const std::string& name) {
  if (name == "hertz_frictionless") return ContactLaw::hertz_frictionless;
  if (name == "paper") return ContactLaw::paper;
  if (name == "hooke") return ContactLaw::hooke;
  if (name == "jkr") return ContactLaw::jkr;
  if (name == "sjkr") return ContactLaw::sjkr;
  return ContactLaw::hertz_mindlin;
}

Material parse_material(const Node& node) {
  Material material;
  node.read("name", material.name);
  for (const char* key : {"density", "young", "poisson"}) require_figure(node, key);
  node.read("density", material.density);
  node.read("young", material.young);
  node.read("poisson", material.poisson);
  node.read("hardness", material.hardness);
  return material;
}

ParticleSensor parse_sensor(const Node& node, const Names& bodies) {
  ParticleSensor sensor;
  node.read("name", sensor.name);
  if (node.has("wall") == node.has("shape"))
    node.fail(
        node.has("wall") ? "the sensor has a wall and a region" : "the sensor has neither 'shape' nor 'wall'",
        "give 'shape', a region whose spheres are measured, or 'wall', the name of a wall");
  if (node.has("wall")) {
    node.read("wall", sensor.wall);
    for (const char* key : {"body", "position", "orientation", "relative_to", "flow"})
      if (node.has(key))
        node.fail(std::string("'") + key + "' is of a region, and this is the sensor of a wall",
                  "leave it out");
    return sensor;
  }
  parse_region(node, bodies, sensor);
  return sensor;
}

}  // namespace

void parse_region(const Node& node, const Names& bodies, ParticleSensor& sensor) {
  sensor.body = read_body(node, "body", bodies);
  node.read("position", sensor.pose.p_WB);
  node.read("orientation", sensor.pose.q_WB);
  const Node shape = node.at("shape");
  if (shape.type() == "box") {
    BoxShape box;
    shape.read("size", box.size);
    sensor.shape = box;
  } else {
    CylinderShape cylinder;
    shape.read("radius", cylinder.radius);
    shape.read("height", cylinder.height);
    sensor.shape = cylinder;
  }
  if (node.has("flow"))
    sensor.flow_axis = static_cast<std::size_t>(node.value().at("flow").get<std::string>()[0] - 'x');
}

Dem parse_dem(const Node& node, const Names& bodies) {
  Dem dem;
  read_server(node, dem);
  for (const Node& material : node.elements("materials")) dem.materials.push_back(parse_material(material));
  const auto materials = node.names("materials");
  if (node.has("contact")) dem.contact = contact_law(node.value().at("contact").get<std::string>());
  const auto chosen = [&](const char* key) { return node.has(key) && node.value().at(key) != "none"; };
  dem.rolling = chosen("rolling");
  dem.twisting = chosen("twisting");
  parse_pairs(node, dem);
  if (node.has("variant")) dem.force_generic = node.value().at("variant") == "generic";
  if (node.has("precision") && node.value().at("precision") == "double") dem.precision = Precision::full;
  dem.auto_step = node.has("micro_step") && node.value().at("micro_step") == "auto";
  if (!dem.auto_step) node.read("micro_step", dem.micro_step);
  dem.relax_start = node.has("start_overlap") && node.value().at("start_overlap") == "relax";
  node.read("overlap_limit", dem.overlap_limit);
  node.read("speed_limit", dem.speed_limit);
  node.read("skin", dem.skin);
  node.names("particles");
  for (const Node& group : node.elements("particles")) dem.particles.push_back(parse_group(group, materials));
  if (node.has("settle")) read_keys(node.at("settle"), dem.settle.emplace());
  node.names("outlets");
  for (const Node& outlet : node.elements("outlets")) dem.outlets.push_back(parse_outlet(outlet));
  node.names("sensors");
  for (const Node& sensor : node.elements("sensors")) dem.sensors.push_back(parse_sensor(sensor, bodies));
  const Node domain = node.at("domain");
  domain.read("min", dem.domain.min);
  domain.read("max", dem.domain.max);
  if (domain.has("follows")) dem.follows = BodyId{domain.resolve("follows", bodies, "bodies")};
  if (domain.has("periodic"))
    for (const auto& axis : domain.value().at("periodic"))
      dem.periodic[static_cast<std::size_t>(axis.get<std::string>()[0] - 'x')] = true;
  return dem;
}

}  // namespace tandem::scene
