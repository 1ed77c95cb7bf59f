#include "common/scene/parse_parts.hpp"

namespace tandem::scene {

namespace {

ContactLaw contact_law(const std::string& name) {
  if (name == "hertz_frictionless") return ContactLaw::hertz_frictionless;
  if (name == "paper") return ContactLaw::paper;
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

// A pair may carry the constants of laws other than the scene's, so that laws can be compared on one file;
// those of the scene's law have no default.
void require_constants(const Node& node, ContactLaw law) {
  const auto require = [&](const char* key, const char* law_name) {
    if (!node.has(key))
      node.fail(std::string("the key '") + key + "' is missing",
                std::string("contact '") + law_name + "' needs it for every pair");
  };
  switch (law) {
    case ContactLaw::hertz_mindlin:
      require("restitution", "hertz_mindlin");
      require("friction", "hertz_mindlin");
      break;
    case ContactLaw::hertz_frictionless:
      require("restitution", "hertz_frictionless");
      break;
    case ContactLaw::paper:
      for (const char* key :
           {"friction", "normal_stiffness", "normal_damping", "tangential_stiffness", "tangential_damping"})
        require(key, "paper");
      break;
  }
}

Pair parse_pair(const Node& node, const std::vector<std::string>& materials) {
  Pair pair;
  pair.a = MaterialId{node.resolve("a", materials, "materials")};
  pair.b = MaterialId{node.resolve("b", materials, "materials")};
  node.read("restitution", pair.restitution);
  node.read("friction", pair.friction);
  node.read("normal_stiffness", pair.normal_stiffness);
  node.read("normal_damping", pair.normal_damping);
  node.read("tangential_stiffness", pair.tangential_stiffness);
  node.read("tangential_damping", pair.tangential_damping);
  return pair;
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

ParticleGroup parse_group(const Node& node, const std::vector<std::string>& materials) {
  ParticleGroup group;
  node.read("name", group.name);
  group.material = MaterialId{node.resolve("material", materials, "materials")};
  if (node.has("radius")) {
    const nlohmann::json& radius = node.value().at("radius");
    group.radius_min = (radius.is_array() ? radius[0] : radius).get<double>();
    group.radius_max = (radius.is_array() ? radius[1] : radius).get<double>();
  }
  node.read("velocity", group.velocity);
  const Node fill = node.at("fill");
  if (fill.type() == "lattice") {
    if (!node.has("radius"))
      node.fail("the key 'radius' is missing", "add radius: a lattice needs the radius of its spheres [m]");
    group.fill = parse_lattice(fill);
  } else {
    FileFill file;
    fill.read("file", file.file);
    group.fill = file;
  }
  return group;
}

Wall parse_wall(const Node& node, const std::vector<std::string>& bodies,
                const std::vector<std::string>& materials) {
  Wall wall;
  node.read("name", wall.name);
  wall.body = read_body(node, "body", bodies);
  wall.material = MaterialId{node.resolve("material", materials, "materials")};
  node.read("position", wall.pose.p_WB);
  node.read("orientation", wall.pose.q_WB);
  const Node shape = node.at("shape");
  const std::string type = shape.type();
  if (type == "plane") {
    PlaneShape plane;
    shape.read("point", plane.point);
    shape.read_unit("normal", plane.normal);
    wall.shape = plane;
  } else if (type == "box") {
    BoxShape box;
    shape.read("size", box.size);
    shape.read("open", box.open);
    wall.shape = box;
  } else if (type == "cylinder") {
    CylinderShape cylinder;
    shape.read("radius", cylinder.radius);
    shape.read("height", cylinder.height);
    shape.read("segments", cylinder.segments);
    shape.read("open", cylinder.open);
    wall.shape = cylinder;
  } else {
    MeshShape mesh;
    shape.read("file", mesh.file);
    shape.read("scale", mesh.scale);
    wall.shape = mesh;
  }
  return wall;
}

}  // namespace

Dem parse_dem(const Node& node, const std::vector<std::string>& bodies) {
  Dem dem;
  for (const Node& material : node.elements("materials")) dem.materials.push_back(parse_material(material));
  const auto materials = node.names("materials");
  if (node.has("contact")) dem.contact = contact_law(node.value().at("contact").get<std::string>());
  for (const Node& pair : node.elements("pairs")) {
    require_constants(pair, dem.contact);
    dem.pairs.push_back(parse_pair(pair, materials));
  }
  if (node.has("variant")) dem.force_generic = node.value().at("variant") == "generic";
  if (node.has("precision") && node.value().at("precision") == "double") dem.precision = Precision::full;
  node.read("micro_step", dem.micro_step);
  node.read("skin", dem.skin);
  node.names("particles");
  for (const Node& group : node.elements("particles")) dem.particles.push_back(parse_group(group, materials));
  node.names("walls");
  for (const Node& wall : node.elements("walls")) dem.walls.push_back(parse_wall(wall, bodies, materials));
  const Node domain = node.at("domain");
  domain.read("min", dem.domain.min);
  domain.read("max", dem.domain.max);
  return dem;
}

}  // namespace tandem::scene
