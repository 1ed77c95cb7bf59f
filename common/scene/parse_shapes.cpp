#include <algorithm>

#include "common/scene/fault.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/parse_parts.hpp"
#include "common/scene/shape_mesh.hpp"

namespace tandem::scene {

namespace {

HullShape parse_hull(const Node& node) {
  HullShape hull;
  if (node.has("points") == node.has("file"))
    node.fail(std::string("the hull has ") +
                  (node.has("points") ? "points and a file" : "neither points nor a file"),
              "give one of them");
  for (const Node& point : node.elements("points")) {
    const nlohmann::json& p = point.value();
    hull.points.push_back({p[0].get<double>(), p[1].get<double>(), p[2].get<double>()});
  }
  node.read("file", hull.file);
  node.read("scale", hull.scale);
  if (node.has("scale") && !node.has("file"))
    node.fail("scale", "the scale is for the corners in a file",
              "leave it out, and give the points in metres");
  return hull;
}

HeightFieldShape parse_height_field(const Node& node) {
  HeightFieldShape field;
  const nlohmann::json& size = node.value().at("size");
  field.size_x = size[0].get<double>();
  field.size_y = size[1].get<double>();
  node.read("heights", field.heights);
  node.read("base", field.base);
  const std::size_t columns = field.heights.front().size();
  for (std::size_t row = 0; row < field.heights.size(); ++row) {
    if (field.heights[row].size() != columns)
      node.fail(element("heights", row).c_str(),
                "the row has " + std::to_string(field.heights[row].size()) + " heights, and the first has " +
                    std::to_string(columns),
                "all rows of the grid have the same number");
    for (std::size_t column = 0; field.base && column < columns; ++column)
      if (const double z = field.heights[row][column]; !(z > *field.base))
        node.fail(element(element("heights", row), column).c_str(),
                  "the height of " + text(z) + " m is not above the base at " + text(*field.base) + " m",
                  "give a lower base");
  }
  return field;
}

Geometry parse_geometry(const Node& node) {
  const std::string type = node.type();
  if (type == "plane") {
    PlaneShape plane;
    node.read("point", plane.point);
    node.read_unit("normal", plane.normal);
    return plane;
  }
  if (type == "box") {
    BoxShape box;
    node.read("size", box.size);
    node.read("open", box.open);
    return box;
  }
  if (type == "cylinder") {
    CylinderShape cylinder;
    node.read("radius", cylinder.radius);
    node.read("height", cylinder.height);
    node.read("segments", cylinder.segments);
    node.read("open", cylinder.open);
    return cylinder;
  }
  if (type == "sphere") {
    SphereShape sphere;
    node.read("radius", sphere.radius);
    return sphere;
  }
  if (type == "capsule") {
    CapsuleShape capsule;
    node.read("radius", capsule.radius);
    node.read("height", capsule.height);
    node.read("segments", capsule.segments);
    return capsule;
  }
  if (type == "cone") {
    ConeShape cone;
    node.read("radius", cone.radius);
    node.read("top_radius", cone.top_radius);
    node.read("height", cone.height);
    node.read("segments", cone.segments);
    node.read("open", cone.open);
    if (cone.top_radius == 0 && std::ranges::find(cone.open, "+z") != cone.open.end())
      node.fail("open", "the upper end is an apex, and not there to be open",
                "leave out +z, or give top_radius");
    return cone;
  }
  if (type == "convex_hull") return parse_hull(node);
  if (type == "height_field") return parse_height_field(node);
  MeshShape mesh;
  node.read("file", mesh.file);
  node.read("scale", mesh.scale);
  node.read("stretch", mesh.stretch);
  return mesh;
}

SurfaceVelocity parse_constant_surface_velocity(const Node& node) {
  SurfaceVelocity surface;
  Vec3d v;
  node.read("surface_velocity", v);
  const double speed = norm(v);
  if (speed == 0)
    node.fail("surface_velocity", "the velocity is 0",
              "leave it out, or give the velocity of the surface [m/s]");
  surface.direction = (1 / speed) * v;
  surface.speed = ConstantMotion{speed, 0};
  return surface;
}

// Three numbers are a constant velocity.
SurfaceVelocity parse_surface_velocity(const Node& node, const std::string& format) {
  const Node value = node.at("surface_velocity");
  if (!value.value().is_object()) return parse_constant_surface_velocity(node);
  SurfaceVelocity surface;
  value.read_unit("direction", surface.direction);
  surface.speed = parse_motion(value.at("speed"), format);
  return surface;
}

Shape parse_placed(const Node& node) {
  Shape shape;
  node.read("name", shape.name);
  node.read("position", shape.pose.p_WB);
  node.read("orientation", shape.pose.q_WB);
  shape.geometry = parse_geometry(node.at("shape"));
  shape.colour = read_colour(node);
  shape.path = node.path();
  return shape;
}

// What walls and shapes have in common.
Shape parse_common(const Node& node, const Names& materials) {
  Shape shape = parse_placed(node);
  if (node.has("material")) shape.material = MaterialId{node.resolve("material", materials, "materials")};
  return shape;
}

// `surfaces`: the materials of mbd.contact.
Shape parse_contact_shape(const Node& node, const Names& surfaces) {
  if (!node.has("material"))
    node.fail("the key 'material' is missing", "add material: the name of one in mbd.contact.materials");
  Shape shape = parse_placed(node);
  shape.use = ShapeUse::contact;
  shape.contact_material = static_cast<int>(node.resolve("material", surfaces, "materials"));
  return shape;
}

BodyContact parse_contact(const Node& node, const Names& surfaces, const Names& bodies) {
  BodyContact contact;
  if (node.has("impacts")) {
    const auto impacts = node.value().at("impacts").get<std::string>();
    if (impacts == "within_steps") contact.impacts = Impacts::within_steps;
    if (impacts == "time_stepping") contact.impacts = Impacts::time_stepping;
  }
  for (const Node& from : node.elements("materials")) {
    ContactMaterial material;
    from.read("name", material.name);
    from.read("stiffness", material.stiffness);
    from.read("young", material.young);
    from.read("poisson", material.poisson);
    from.read("restitution", material.restitution);
    from.read("friction", material.friction);
    from.read("rolling_friction", material.rolling_friction);
    if (from.has("young") != from.has("poisson"))
      from.fail(std::string(from.has("young") ? "'young' without 'poisson'" : "'poisson' without 'young'"),
                "give both, or the stiffness of a point of contact [N/m]");
    if (from.has("young") == from.has("stiffness"))
      from.fail(from.has("young") ? "the material has a stiffness and Young's modulus"
                                  : "the material has neither a stiffness nor Young's modulus",
                "give stiffness [N/m], or young [Pa] and poisson");
    contact.materials.push_back(material);
  }
  for (const Node& from : node.elements("pairs")) {
    ContactMaterialPair pair{static_cast<int>(from.resolve("a", surfaces, "materials")),
                             static_cast<int>(from.resolve("b", surfaces, "materials")),
                             {},
                             {},
                             {},
                             {}};
    from.read("stiffness", pair.stiffness);
    from.read("restitution", pair.restitution);
    from.read("friction", pair.friction);
    from.read("rolling_friction", pair.rolling_friction);
    for (const ContactMaterialPair& other : contact.pairs)
      if ((other.a == pair.a && other.b == pair.b) || (other.a == pair.b && other.b == pair.a))
        from.fail("the pair is given twice", "leave one of them out");
    contact.pairs.push_back(pair);
  }
  node.names("ground");
  for (const Node& from : node.elements("ground")) {
    Shape& shape = contact.ground.emplace_back(parse_contact_shape(from, surfaces));
    if (from.has("surface_velocity")) shape.surface_velocity = parse_constant_surface_velocity(from);
  }
  for (const Node& from : node.elements("ignore")) {
    std::array<BodyId, 2> pair;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto name = from.value()[i].get<std::string>();
      const auto body = bodies.index(name);
      if (!body && name != "ground")
        from.fail("unknown name '" + name + "'", suggest_name(name, bodies.list(), "bodies"));
      pair[i] = body ? BodyId{*body} : ground;
    }
    if (pair[0] == pair[1])
      from.fail("both names are '" + from.value()[0].get<std::string>() + "'",
                "give two bodies that may pass through each other");
    contact.ignore.push_back(pair);
  }
  return contact;
}

Shape parse_body_shape(const Node& node, BodyId body, const Scene& scene, const Names& materials,
                       const Names* surfaces) {
  const auto use = node.value().at("use").get<std::string>();
  const Body& owner = scene.mbd->bodies[body.value];
  if (!scene.has_particles() && use == "wall")
    node.fail("use", "there are no particles to be a wall for", "give graphics, or add dem or sph");
  if (!scene.dem && use != "contact" && node.has("material"))
    node.fail("material", "materials are those of dem, which the scene does not have", "give the density");
  if (use == "wall" && scene.dem && !node.has("material"))
    node.fail("the key 'material' is missing", "add material: a wall is in contact with particles");
  if (use == "contact" && !surfaces)
    node.fail("use", "the scene has no mbd.contact, which gives the materials of contacts",
              "add mbd.contact, or give graphics");
  if (node.has("density") && !owner.from_shapes)
    node.fail("density", "the mass of '" + owner.name + "' is a number, and needs no density",
              "leave it out, or give \"mass\": \"from_shapes\"");
  Shape shape = use == "contact" ? parse_contact_shape(node, *surfaces) : parse_common(node, materials);
  if (use != "contact") shape.use = use == "wall" ? ShapeUse::wall : ShapeUse::graphics;
  shape.body = body;
  shape.is_of_body = true;
  node.read("density", shape.density);
  return shape;
}

// Only surfaces that the particles know exactly, or facets that the scene asks for.
void require_surface(const Node& node, const Shape& shape) {
  const auto* capsule = std::get_if<CapsuleShape>(&shape.geometry);
  const auto* cone = std::get_if<ConeShape>(&shape.geometry);
  if ((capsule && !capsule->segments) || (cone && !cone->segments))
    node.at("shape").fail(std::string("particles know no round surface of a ") + (cone ? "cone" : "capsule"),
                          "add segments: flat faces, inscribed, whose corners are at the radius");
}

// A body is one surface in pictures, of one colour.
void require_colour_of_ground(const Node& node, const Shape& shape) {
  if (shape.colour && shape.body != ground)
    node.fail("color", "the wall is on a body, which has one colour in pictures",
              "give the colour to the body");
}

// A wall of the liquid with the name of a wall of the grains is the same surface: meshes and pictures have it
// once.
void expect_same_wall(const Node& root, const Node& of_liquid) {
  for (const Node& of_grains : root.at("dem").elements("walls")) {
    if (of_grains.value().at("name") != of_liquid.value().at("name")) continue;
    for (const char* key : {"body", "position", "orientation", "shape", "color"}) {
      const nlohmann::json none, &a = of_grains.has(key) ? of_grains.value().at(key) : none,
                                 &b = of_liquid.has(key) ? of_liquid.value().at(key) : none;
      if (a != b)
        of_liquid.fail("name",
                       "the name '" + of_liquid.value().at("name").get<std::string>() + "' is that of " +
                           of_grains.path() + ", which has another " + key,
                       "choose another name, or write the same surface");
    }
  }
}

}  // namespace

void parse_shapes(const Node& root, Scene& scene) {
  Names bodies, materials, walls;
  if (scene.mbd)
    for (const Body& body : scene.mbd->bodies) bodies.add(body.name);
  if (scene.dem)
    for (const Material& material : scene.dem->materials) materials.add(material.name);

  const auto add = [&](const Node& node, Shape shape) {
    if (shape.use == ShapeUse::wall) {
      require_surface(node, shape);
      if (scene.dem && shape.for_grains) scene.dem->walls.push_back(wall_of(shape));
      if (scene.sph && shape.for_liquid) scene.sph->walls.push_back(wall_of(shape));
    }
    scene.shapes.push_back(std::move(shape));
  };
  if (scene.dem) {
    walls = root.at("dem").names("walls");
    for (const Node& node : root.at("dem").elements("walls")) {
      Shape shape = parse_common(node, materials);
      shape.body = read_body(node, "body", bodies);
      require_colour_of_ground(node, shape);
      shape.for_liquid = false;
      if (node.has("surface_velocity")) shape.surface_velocity = parse_surface_velocity(node, scene.format);
      add(node, std::move(shape));
    }
  }
  if (scene.sph) {
    root.at("sph").names("walls");
    for (const Node& node : root.at("sph").elements("walls")) {
      Shape shape = parse_placed(node);
      shape.body = read_body(node, "body", bodies);
      require_colour_of_ground(node, shape);
      shape.for_grains = false;
      if (!walls.add(shape.name)) expect_same_wall(root, node);
      add(node, std::move(shape));
    }
  }
  if (!scene.mbd) return;
  std::optional<Names> surfaces;
  if (const Node mbd = root.at("mbd"); mbd.has("contact")) {
    surfaces = mbd.at("contact").names("materials");
    scene.contact = parse_contact(mbd.at("contact"), *surfaces, bodies);
    scene.contact->outputs = parse_contact_outputs(mbd, bodies);
  }
  const std::vector<Node> nodes = root.at("mbd").elements("bodies");
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].has("shapes")) continue;
    nodes[i].names("shapes");
    for (const Node& node : nodes[i].elements("shapes")) {
      Shape shape = parse_body_shape(node, {i}, scene, materials, surfaces ? &*surfaces : nullptr);
      if (shape.use == ShapeUse::wall && !walls.add(shape.name))
        node.fail("name", "the name '" + shape.name + "' is that of another wall", "choose another name");
      add(node, std::move(shape));
    }
  }
}

}  // namespace tandem::scene
