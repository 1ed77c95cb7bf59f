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
  node.read("density", material.density);
  node.read("young", material.young);
  node.read("poisson", material.poisson);
  return material;
}

LatticeFill parse_lattice(const Node& node) {
  LatticeFill fill;
  node.read("min", fill.min);
  node.read("max", fill.max);
  node.read("lattice", fill.lattice);
  node.read("spacing", fill.spacing);
  node.read("jitter", fill.jitter);
  node.read("seed", fill.seed);
  node.read("count", fill.count);
  return fill;
}

InletFill parse_inlet(const Node& node) {
  InletFill fill;
  node.read("min", fill.min);
  node.read("max", fill.max);
  node.read("rate", fill.rate);
  node.read("mass_rate", fill.mass_rate);
  if (fill.rate.has_value() == fill.mass_rate.has_value())
    node.fail(
        std::string("the inlet has ") + (fill.rate ? "a rate and a mass_rate" : "neither rate nor mass_rate"),
        "give one of them: spheres or mass per second");
  node.read("start", fill.start);
  node.read("count", fill.count);
  node.read("seed", fill.seed);
  return fill;
}

Outlet parse_outlet(const Node& node) {
  Outlet outlet;
  node.read("name", outlet.name);
  const Node region = node.at("region");
  if (region.type() == "box") {
    Box box;
    region.read("min", box.min);
    region.read("max", box.max);
    outlet.region = box;
  } else {
    HalfSpace beyond;
    region.read("point", beyond.point);
    region.read_unit("normal", beyond.normal);
    outlet.region = beyond;
  }
  return outlet;
}

ParticleSensor parse_sensor(const Node& node, const Names& bodies) {
  ParticleSensor sensor;
  node.read("name", sensor.name);
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
  return sensor;
}

ParticleGroup parse_group(const Node& node, const Names& materials) {
  ParticleGroup group;
  node.read("name", group.name);
  group.material = MaterialId{node.resolve("material", materials, "materials")};
  if (node.has("radius")) {
    const nlohmann::json& radius = node.value().at("radius");
    group.radius_min = (radius.is_array() ? radius[0] : radius).get<double>();
    group.radius_max = (radius.is_array() ? radius[1] : radius).get<double>();
  }
  node.read("velocity", group.velocity);
  node.read("fixed", group.fixed);
  const Node fill = node.at("fill");
  if (group.fixed && node.has("velocity"))
    node.fail("velocity", "the spheres of a fixed group never move", "leave out velocity, or fixed");
  if (group.fixed && fill.type() == "inlet")
    node.fail("fixed", "spheres that come in through an inlet move", "leave out fixed, or fill a lattice");
  if (fill.type() != "file" && !node.has("radius"))
    node.fail("the key 'radius' is missing", std::string("add radius: ") +
                                                 (fill.type() == "lattice" ? "a lattice" : "an inlet") +
                                                 " needs the radius of its spheres [m]");
  if (fill.type() == "lattice") {
    group.fill = parse_lattice(fill);
  } else if (fill.type() == "inlet") {
    group.fill = parse_inlet(fill);
  } else {
    FileFill file;
    fill.read("file", file.file);
    group.fill = file;
  }
  return group;
}

}  // namespace

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
