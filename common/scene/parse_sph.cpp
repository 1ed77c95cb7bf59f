#include "common/scene/parse_parts.hpp"

namespace tandem::scene {

namespace {

Liquid parse_liquid(const Node& node) {
  Liquid liquid;
  node.read("name", liquid.name);
  node.read("density", liquid.density);
  node.read("viscosity", liquid.viscosity);
  node.read("sound_speed", liquid.sound_speed);
  node.read("expected_speed", liquid.expected_speed);
  node.read("artificial_viscosity", liquid.artificial_viscosity);
  if (liquid.sound_speed && node.has("expected_speed"))
    node.fail("expected_speed", "the speed of sound is given, and expected_speed is for choosing it",
              "leave one of them out");
  node.read("velocity", liquid.velocity);
  if (node.has("pressure") && node.value().at("pressure") == "zero") liquid.pressure = StartPressure::zero;
  for (const Node& from : node.elements("fill")) {
    Box& box = liquid.fill.emplace_back();
    from.read("min", box.min);
    from.read("max", box.max);
  }
  return liquid;
}

}  // namespace

Sph parse_sph(const Node& node) {
  Sph sph;
  read_server(node, sph);
  node.read("spacing", sph.spacing);
  node.names("liquids");
  for (const Node& liquid : node.elements("liquids")) sph.liquids.push_back(parse_liquid(liquid));
  if (node.has("wall_friction") && node.value().at("wall_friction") == "free_slip")
    sph.wall_friction = WallFriction::free_slip;
  if (node.has("precision") && node.value().at("precision") == "double")
    sph.precision = LiquidPrecision::full;
  node.read("micro_step", sph.micro_step);
  const Node domain = node.at("domain");
  domain.read("min", sph.domain.min);
  domain.read("max", sph.domain.max);
  if (domain.has("periodic"))
    for (const auto& axis : domain.value().at("periodic"))
      sph.periodic[static_cast<std::size_t>(axis.get<std::string>()[0] - 'x')] = true;
  return sph;
}

}  // namespace tandem::scene
