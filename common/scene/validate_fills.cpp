// Sizes, and fills that are placed before the start.
#include <algorithm>
#include <cmath>

#include "common/scene/nearest_name.hpp"
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

void require_same_length(std::size_t a, std::size_t b, const std::string& of, const std::string& other,
                         const std::string& origin, const std::string& path) {
  if (a != b)
    fail(origin, path, of + " has " + std::to_string(a) + " values and " + other + " " + std::to_string(b),
         "give one for each");
}

void validate_list(const ListedSizes& sizes, const std::string& origin, const std::string& path) {
  require_same_length(sizes.radius.size(), sizes.mass_fraction.size(), "radius", "mass_fraction", origin,
                      path);
  double sum = 0;
  for (const double share : sizes.mass_fraction) sum += share;
  if (std::abs(sum - 1) > 1e-6)
    fail(origin, path + ".mass_fraction", "the sum is " + rounded(sum), "the mass fractions add up to 1");
}

void validate_sieve(const SieveCurve& sizes, const std::string& origin, const std::string& path) {
  require_same_length(sizes.size.size(), sizes.passing.size(), "size", "passing", origin, path);
  for (std::size_t i = 1; i < sizes.size.size(); ++i) {
    if (!(sizes.size[i] > sizes.size[i - 1]))
      fail(origin, element(path + ".size", i),
           text(sizes.size[i]) + " m follows " + text(sizes.size[i - 1]) + " m",
           "give the sieves from the finest to the coarsest");
    if (sizes.passing[i] < sizes.passing[i - 1])
      fail(origin, element(path + ".passing", i),
           text(sizes.passing[i]) + " follows " + text(sizes.passing[i - 1]),
           "what passes a sieve passes every coarser one: give shares that do not decrease");
  }
  if (sizes.passing.front() != 0)
    fail(origin, element(path + ".passing", 0), "the value is " + text(sizes.passing.front()),
         "nothing passes the finest sieve: give 0, with the smallest diameter as its size");
  if (sizes.passing.back() != 1)
    fail(origin, element(path + ".passing", sizes.passing.size() - 1),
         "the value is " + text(sizes.passing.back()),
         "everything passes the coarsest sieve: give 1, with the largest diameter as its size");
}

// `low`, `high`: the cut in standard deviations from the middle.
void validate_cut(double min, double max, double low, double high, const std::string& origin,
                  const std::string& path) {
  if (!(min < max))
    fail(origin, path + ".max",
         "the largest radius of " + text(max) + " m is not above the smallest of " + text(min) + " m",
         "give min < max");
  const double left = 0.5 * (std::erfc(-high / std::sqrt(2.0)) - std::erfc(-low / std::sqrt(2.0)));
  if (!(left > 1e-6))
    fail(origin, path, "min and max leave " + rounded(std::max(left, 0.0)) + " of the distribution",
         "let the middle of the distribution be between min and max, or nearer to them");
}

void validate_sizes(const Sizes& sizes, const std::string& origin, const std::string& path) {
  if (const auto* list = std::get_if<ListedSizes>(&sizes)) validate_list(*list, origin, path);
  if (const auto* sieve = std::get_if<SieveCurve>(&sizes)) validate_sieve(*sieve, origin, path);
  if (const auto* normal = std::get_if<NormalSizes>(&sizes))
    validate_cut(normal->min, normal->max, (normal->min - normal->mean) / normal->deviation,
                 (normal->max - normal->mean) / normal->deviation, origin, path);
  if (const auto* normal = std::get_if<LogNormalSizes>(&sizes))
    validate_cut(normal->min, normal->max, std::log(normal->min / normal->median) / normal->deviation,
                 std::log(normal->max / normal->median) / normal->deviation, origin, path);
}

void require_wall(const Scene& scene, const std::string& name, const std::string& origin,
                  const std::string& path) {
  std::vector<std::string> names;
  for (const Wall& wall : scene.dem->walls) names.push_back(wall.name);
  if (std::ranges::find(names, name) == names.end())
    fail(origin, path, "unknown name '" + name + "'", suggest_name(name, names, "walls"));
}

void validate_region(const Scene& scene, const PackingFill& fill, double largest, const std::string& origin,
                     const std::string& path) {
  const Box& domain = scene.dem->domain;
  const auto require_inside = [&](Vec3d min, Vec3d max) {
    for (int a = 0; a < 3; ++a) {
      if (min[a] < domain.min[a] || max[a] > domain.max[a])
        fail(origin, path,
             "the region reaches from " + text(min) + " m to " + text(max) + " m, beyond the domain",
             "enlarge dem.domain, or move the region");
      if (max[a] - min[a] < 2 * largest)
        fail(origin, path,
             "the region is " + rounded(max[a] - min[a]) + " m wide along " + "xyz"[a] +
                 ", too narrow for a sphere of radius " + text(largest) + " m",
             "enlarge the region, or give smaller spheres");
    }
  };
  if (const auto* box = std::get_if<Box>(&fill.region)) {
    require_box(box->min, box->max, origin, path);
    require_inside(box->min, box->max);
  } else if (const auto* cylinder = std::get_if<CylinderRegion>(&fill.region)) {
    const Vec3d axis = cylinder->to - cylinder->from;
    if (!(norm(axis) > 0))
      fail(origin, path + ".to", "the ends are both at " + text(cylinder->from), "give two points");
    Vec3d half;  // extent of an end along each axis
    for (int a = 0; a < 3; ++a)
      half[a] = cylinder->radius * std::sqrt(std::max(0.0, 1 - axis[a] * axis[a] / norm2(axis)));
    Vec3d min, max;
    for (int a = 0; a < 3; ++a) {
      min[a] = std::min(cylinder->from[a], cylinder->to[a]) - half[a];
      max[a] = std::max(cylinder->from[a], cylinder->to[a]) + half[a];
    }
    require_inside(min, max);
  } else if (const auto* above = std::get_if<AboveWall>(&fill.region)) {
    require_wall(scene, above->wall, origin, path + ".wall");
    const Vec3d g = scene.gravity;
    if (g.x != 0 || g.y != 0 || g.z > 0)
      fail(origin, path, "the region is above a wall along z, and gravity is " + text(g),
           "give another region, or gravity along -z");
    for (std::size_t a = 0; above->min && a < 2; ++a) {
      const int axis = static_cast<int>(a);
      const double low = (*above->min)[a], high = (*above->max)[a];
      if (!(high - low >= 2 * largest))
        fail(origin, element(path + ".max", a),
             text(high) + " m is not a diameter of " + text(2 * largest) + " m beyond " + text(low) + " m",
             "give the lower corner as min, and a rectangle that holds a sphere");
      if (low < domain.min[axis] || high > domain.max[axis])
        fail(origin, path, std::string("the rectangle reaches beyond the domain along ") + "xyz"[axis],
             "enlarge dem.domain, or move the region");
    }
    if (above->height && *above->height < 2 * largest)
      fail(origin, path + ".height",
           text(*above->height) + " m is less than the largest diameter of " + text(2 * largest) + " m",
           "give a higher bed, or smaller spheres");
    if (fill.level.has_value() == above->height.has_value())
      fail(origin, fill.level ? path.substr(0, path.rfind('.')) + ".level" : path,
           fill.level ? "the bed above a wall has a height" : "the room above a wall has no upper end",
           fill.level ? "leave out level, or height"
                      : "give the bed a height, or the fill a level up to which it reaches");
  } else if (const auto* between = std::get_if<BetweenWalls>(&fill.region)) {
    for (std::size_t i = 0; i < between->walls.size(); ++i)
      require_wall(scene, between->walls[i], origin, element(path + ".walls", i));
  } else {
    require_wall(scene, std::get<InsideWall>(fill.region).wall, origin, path + ".wall");
  }
}

void validate_settle(const Scene& scene, const std::string& origin) {
  if (scene.gravity == Vec3d{})
    fail(origin, "dem.settle", "the scene has no gravity, without which no bed forms",
         "leave out settle, or give gravity");
  if (std::ranges::none_of(scene.dem->particles, [](const ParticleGroup& group) {
        return !group.fixed && !std::holds_alternative<InletFill>(group.fill);
      }))
    fail(origin, "dem.settle", "no sphere that moves is there at the start",
         "leave out settle, or add a group that moves and has no inlet");
}

}  // namespace

void validate_fills(const Scene& scene, const std::string& origin) {
  if (!scene.dem) return;
  if (scene.dem->settle) validate_settle(scene, origin);
  for (std::size_t i = 0; i < scene.dem->particles.size(); ++i) {
    const ParticleGroup& group = scene.dem->particles[i];
    const std::string path = element("dem.particles", i);
    if (group.sizes) validate_sizes(*group.sizes, origin, path + ".sizes");
    const auto* fill = std::get_if<PackingFill>(&group.fill);
    if (fill == nullptr) continue;
    validate_region(scene, *fill, group.radius_max, origin, path + ".fill.region");
  }
}

}  // namespace tandem::scene
