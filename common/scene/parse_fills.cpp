#include "common/scene/parse_parts.hpp"

namespace tandem::scene {

namespace {

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

decltype(PackingFill::region) parse_region(const Node& node) {
  if (node.type() == "inside") {
    InsideWall region;
    node.read("wall", region.wall);
    return region;
  }
  if (node.type() == "box") {
    Box region;
    node.read("min", region.min);
    node.read("max", region.max);
    return region;
  }
  if (node.type() == "cylinder") {
    CylinderRegion region;
    node.read("from", region.from);
    node.read("to", region.to);
    node.read("radius", region.radius);
    return region;
  }
  if (node.type() == "between") {
    BetweenWalls region;
    node.read("walls", region.walls);
    return region;
  }
  AboveWall region;
  node.read("wall", region.wall);
  node.read("min", region.min);
  node.read("max", region.max);
  if (region.min.has_value() != region.max.has_value())
    node.fail(region.min ? "min without max" : "max without min",
              "give both, or neither: the region is then wherever the wall is");
  node.read("height", region.height);
  return region;
}

PackingFill parse_packing(const Node& node) {
  PackingFill fill;
  fill.region = parse_region(node.at("region"));
  node.read("level", fill.level);
  node.read("mass", fill.mass);
  node.read("count", fill.count);
  if (fill.mass && fill.count)
    node.fail("the packing has a mass and a count", "give one of them, or neither: the region is then full");
  node.read("void_fraction", fill.void_fraction);
  node.read("seed", fill.seed);
  return fill;
}

Sizes parse_sizes(const Node& node) {
  if (node.type() == "list") {
    ListedSizes sizes;
    node.read("radius", sizes.radius);
    node.read("mass_fraction", sizes.mass_fraction);
    return sizes;
  }
  if (node.type() == "sieve") {
    SieveCurve sizes;
    node.read("size", sizes.size);
    node.read("passing", sizes.passing);
    return sizes;
  }
  if (node.type() == "normal") {
    NormalSizes sizes;
    node.read("mean", sizes.mean);
    node.read("deviation", sizes.deviation);
    node.read("min", sizes.min);
    node.read("max", sizes.max);
    return sizes;
  }
  LogNormalSizes sizes;
  node.read("median", sizes.median);
  node.read("deviation", sizes.deviation);
  node.read("min", sizes.min);
  node.read("max", sizes.max);
  return sizes;
}

// What the radii of a kind of fill are for; empty where it needs none.
std::string spheres_of(const std::string& fill) {
  if (fill == "lattice") return "a lattice";
  if (fill == "inlet") return "an inlet";
  if (fill == "packing") return "a packing";
  return {};
}

}  // namespace

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
  if (node.has("sizes")) {
    if (node.has("radius")) node.fail("sizes", "the group has a radius and sizes", "keep one of them");
    if (fill.type() != "packing")
      node.fail("sizes", "the fill is of type '" + fill.type() + "', which takes no sizes",
                "give a radius, or a fill of type 'packing'");
    group.sizes = parse_sizes(node.at("sizes"));
    set_radius_limits(group);
  }
  if (group.fixed && node.has("velocity"))
    node.fail("velocity", "the spheres of a fixed group never move", "leave out velocity, or fixed");
  if (group.fixed && fill.type() == "inlet")
    node.fail("fixed", "spheres that come in through an inlet move", "leave out fixed, or fill a lattice");
  if (group.fixed && (fill.type() == "packing" || fill.type() == "run"))
    node.fail("fixed", "spheres of a fill of type '" + fill.type() + "' move",
              "leave out fixed, or give a lattice or a file");
  if (const std::string spheres = spheres_of(fill.type());
      !spheres.empty() && !node.has("radius") && !node.has("sizes"))
    node.fail("the key 'radius' is missing", "add radius: " + spheres +
                                                 " needs the radius of its spheres [m]" +
                                                 (fill.type() == "packing" ? ", or sizes" : ""));
  if (fill.type() == "run" && (node.has("radius") || node.has("velocity")))
    node.fail(node.has("radius") ? "radius" : "velocity",
              "radii and velocities are those of the frame of the run", "leave it out");
  if (fill.type() == "lattice") {
    group.fill = parse_lattice(fill);
  } else if (fill.type() == "inlet") {
    group.fill = parse_inlet(fill);
  } else if (fill.type() == "packing") {
    group.fill = parse_packing(fill);
  } else if (fill.type() == "run") {
    RunFill run;
    fill.read("folder", run.folder);
    fill.read("time", run.time);
    group.fill = run;
  } else {
    FileFill file;
    fill.read("file", file.file);
    group.fill = file;
  }
  return group;
}

}  // namespace tandem::scene
