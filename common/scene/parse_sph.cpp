#include "common/scene/parse_parts.hpp"

namespace tandem::scene {

namespace {

Liquid parse_liquid(const Node& node) {
  Liquid liquid;
  node.read("name", liquid.name);
  for (const char* key : {"density", "viscosity"}) require_figure(node, key);
  node.read("density", liquid.density);
  node.read("viscosity", liquid.viscosity);
  node.read("sound_speed", liquid.sound_speed);
  node.read("expected_speed", liquid.expected_speed);
  node.read("artificial_viscosity", liquid.artificial_viscosity);
  if (liquid.sound_speed && node.has("expected_speed"))
    node.fail("expected_speed", "the speed of sound is given, and expected_speed is for choosing it",
              "leave one of them out");
  if (node.has("velocity")) node.read("velocity", liquid.velocity.emplace());
  if (node.has("pressure") && node.value().at("pressure") == "zero") liquid.pressure = StartPressure::zero;
  node.read("shifting", liquid.shifting);
  for (const Node& from : node.elements("fill")) {
    if (from.type() == "box") {
      Box box;
      from.read("min", box.min);
      from.read("max", box.max);
      liquid.fill.emplace_back(box);
      continue;
    }
    LiquidInside inside;
    from.read("wall", inside.wall);
    from.read("level", inside.level);
    from.read("volume", inside.volume);
    from.read("mass", inside.mass);
    if (const int given =
            int{inside.level.has_value()} + int{inside.volume.has_value()} + int{inside.mass.has_value()};
        given != 1)
      from.fail(given == 0                      ? "the fill has neither level nor volume nor mass"
                : given == 3                    ? "the fill has a level, a volume and a mass"
                : inside.level && inside.volume ? "the fill has a level and a volume"
                : inside.level                  ? "the fill has a level and a mass"
                                                : "the fill has a volume and a mass",
                "give one of them");
    liquid.fill.emplace_back(inside);
  }
  return liquid;
}

WallFriction wall_friction(const Node& node) {
  return node.has("wall_friction") && node.value().at("wall_friction") == "free_slip"
             ? WallFriction::free_slip
             : WallFriction::no_slip;
}

LiquidSensor parse_liquid_sensor(const Node& node, const Names& bodies) {
  LiquidSensor sensor;
  node.read("name", sensor.name);
  const std::string type = node.type();
  if (type == "region") {
    parse_region(node, bodies, sensor);
    return sensor;
  }
  sensor.kind = type == "load"    ? LiquidSensor::Kind::load
                : type == "level" ? LiquidSensor::Kind::level
                                  : LiquidSensor::Kind::pressure;
  node.read("wall", sensor.wall);
  if (!sensor.wall.empty() && node.has("body"))
    node.fail("body", "the sensor has a wall, and the body follows from it", "leave one of them out");
  sensor.body = read_body(node, "body", bodies);
  node.read("position", sensor.pose.p_WB);
  if (node.has("axis")) node.read_unit("axis", sensor.axis.emplace());
  if (node.has("area")) {
    const nlohmann::json& size = node.value().at("area");
    sensor.area = RectangleShape{size[0].get<double>(), size[1].get<double>()};
    node.read("orientation", sensor.pose.q_WB);
  } else if (node.has("orientation")) {
    node.fail("orientation", "the pressure at a point has no orientation", "give an area, or leave it out");
  }
  return sensor;
}

LiquidInlet parse_liquid_inlet(const Node& node) {
  LiquidInlet inlet;
  node.read("name", inlet.name);
  node.read("position", inlet.pose.p_WB);
  node.read("orientation", inlet.pose.q_WB);
  const Node shape = node.at("shape");
  if (shape.type() == "rectangle") {
    const nlohmann::json& size = shape.value().at("size");
    inlet.shape = RectangleShape{size[0].get<double>(), size[1].get<double>()};
  } else {
    DiscShape disc;
    shape.read("radius", disc.radius);
    inlet.shape = disc;
  }
  node.read("velocity", inlet.velocity);
  node.read("flow", inlet.flow);
  if (inlet.velocity.has_value() == inlet.flow.has_value())
    node.fail(
        std::string("the inlet has ") + (inlet.flow ? "a velocity and a flow" : "neither velocity nor flow"),
        "give one of them");
  node.read("start", inlet.start);
  node.read("end", inlet.end);
  return inlet;
}

}  // namespace

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

Sph parse_sph(const Node& node, const Names& bodies) {
  Sph sph;
  read_server(node, sph);
  read_keys(node, sph);
  for (const Node& liquid : node.elements("liquids")) sph.liquids.push_back(parse_liquid(liquid));
  sph.wall_friction = wall_friction(node);
  const Names liquids = node.names("liquids");
  for (const Node& pair : node.elements("pairs")) {
    LiquidPair& read = sph.pairs.emplace_back();
    read.liquid = sph.liquids[pair.resolve("liquid", liquids, "liquids")].name;
    read.body = read_body(pair, "body", bodies);
    read.wall_friction = wall_friction(pair);
  }
  node.names("sensors");
  for (const Node& sensor : node.elements("sensors"))
    sph.sensors.push_back(parse_liquid_sensor(sensor, bodies));
  node.names("inlets");
  for (const Node& inlet : node.elements("inlets")) sph.inlets.push_back(parse_liquid_inlet(inlet));
  node.names("outlets");
  for (const Node& outlet : node.elements("outlets")) sph.outlets.push_back(parse_outlet(outlet));
  if (node.has("precision") && node.value().at("precision") == "double")
    sph.precision = LiquidPrecision::full;
  if (!node.has("domain")) return sph;
  const Node domain = node.at("domain");
  sph.domain_is_given = domain.has("min");
  if (domain.has("min") != domain.has("max"))
    domain.fail("one corner is given without the other", "give min and max, or none of them");
  if (domain.has("periodic") && !domain.has("min"))
    domain.fail("periodic", "the period follows from min and max, which are not given", "give them");
  domain.read("min", sph.domain.min);
  domain.read("max", sph.domain.max);
  if (domain.has("follows")) sph.follows = BodyId{domain.resolve("follows", bodies, "bodies")};
  if (domain.has("periodic"))
    for (const auto& axis : domain.value().at("periodic"))
      sph.periodic[static_cast<std::size_t>(axis.get<std::string>()[0] - 'x')] = true;
  return sph;
}

}  // namespace tandem::scene
