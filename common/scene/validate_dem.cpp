#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/scene/lattice.hpp"
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

using PairKey = std::pair<MaterialId, MaterialId>;

PairKey key_of(MaterialId a, MaterialId b) {
  return {std::min(a, b), std::max(a, b)};
}

// Every two materials that can be in contact need one pair: sphere with sphere, and sphere with wall.
void validate_pairs(const Dem& dem, const std::string& origin) {
  const auto name = [&](MaterialId id) { return "'" + dem.materials[id.value].name + "'"; };
  std::set<PairKey> given;
  for (std::size_t i = 0; i < dem.pairs.size(); ++i) {
    const Pair& pair = dem.pairs[i];
    if (!given.insert(key_of(pair.a, pair.b)).second)
      fail(origin, element("dem.pairs", i),
           "the pair of " + name(pair.a) + " and " + name(pair.b) + " is given twice",
           "keep one of them; the order of a and b does not matter");
  }
  const auto require = [&](MaterialId a, MaterialId b, const std::string& who) {
    if (given.contains(key_of(a, b))) return;
    for (const IncompletePair& pair : dem.incomplete_pairs)
      if (key_of(pair.a, pair.b) == key_of(a, b))
        fail(origin, pair.of_materials ? "dem.materials" : "dem.pairs",
             fmt::format("{} and {} have no '{}', which {} needs", name(a), name(b), pair.missing, pair.by),
             fmt::format("{} can meet: give it {}their pair", who,
                         pair.of_materials ? "to both, or to " : "to "));
    fail(origin, "dem.pairs", "no pair of " + name(a) + " and " + name(b), who + " can meet: add their pair");
  };
  for (const ParticleGroup& group : dem.particles) {
    if (group.fixed) continue;  // is in contact with other groups only, which are checked in turn
    for (const ParticleGroup& other : dem.particles)
      require(group.material, other.material, "spheres of '" + group.name + "' and '" + other.name + "'");
    for (const Wall& wall : dem.walls)
      require(group.material, wall.material, "spheres of '" + group.name + "' and wall '" + wall.name + "'");
  }
}

// Checks the box that contains a group's spheres at their begin.
void validate_box(Vec3d min, Vec3d max, const Box& domain, const std::string& origin,
                  const std::string& path) {
  require_box(min, max, origin, path);
  for (int axis = 0; axis < 3; ++axis) {
    const char* side = min[axis] < domain.min[axis] ? "min" : max[axis] > domain.max[axis] ? "max" : nullptr;
    if (!side) continue;
    const bool low = side[1] == 'i';
    fail(origin, element(path + "." + side, axis),
         text((low ? min : max)[axis]) + " m is outside the domain, which ends at " +
             text((low ? domain.min : domain.max)[axis]) + " m",
         "spheres outside the domain are lost: enlarge dem.domain or move the fill");
  }
}

void validate_inlet(const ParticleGroup& group, const InletFill& fill, const Dem& dem,
                    const std::string& origin, const std::string& path) {
  validate_box(fill.min, fill.max, dem.domain, origin, path);
  for (int axis = 0; axis < 3; ++axis)
    if (fill.max[axis] - fill.min[axis] < 2 * group.radius_max)
      fail(origin, path,
           "the box is " + text(fill.max[axis] - fill.min[axis]) + " m wide along " + "xyz"[axis] +
               ", too narrow for a sphere of radius " + text(group.radius_max) + " m",
           "spheres come in inside the box: enlarge it");
}

void validate_lattice(const ParticleGroup& group, const LatticeFill& fill, const Box& domain,
                      const std::string& origin, const std::string& path) {
  // Spheres that never move cannot be lost.
  if (group.fixed)
    require_box(fill.min, fill.max, origin, path);
  else
    validate_box(fill.min, fill.max, domain, origin, path);
  if (fill.spacing < 2 * group.radius_max)
    fail(origin, path + ".spacing",
         "the spacing of " + text(fill.spacing) + " m is less than the largest diameter of " +
             text(2 * group.radius_max) + " m",
         "spheres would overlap at the start");

  const double capacity = lattice_capacity(fill, group.radius_max);
  if (capacity < 1)
    fail(origin, path, "the box holds no sphere of radius " + text(group.radius_max) + " m", "enlarge it");
  if (fill.count && static_cast<double>(*fill.count) > capacity)
    fail(origin, path + ".count",
         std::to_string(*fill.count) + " spheres do not fit: the lattice has " + rounded(capacity) + " sites",
         "enlarge the box, or reduce count or spacing");
  // largest number that a count allows
  constexpr double most = 2147483647;
  if (!fill.count && capacity > most)
    fail(origin, path, "the lattice has " + rounded(capacity) + " sites, more than " + text(most),
         "give a count");
}

void validate_groups(const Dem& dem, const std::string& origin) {
  if (dem.particles.empty())
    fail(origin, "dem.particles", "the scene has no sphere", "add a group, or leave out dem");
  if (std::ranges::all_of(dem.particles, &ParticleGroup::fixed))
    fail(origin, "dem.particles", "all groups are fixed: the scene has no sphere that moves",
         "add a group without fixed, or leave out dem");
  for (std::size_t i = 0; i < dem.particles.size(); ++i) {
    const ParticleGroup& group = dem.particles[i];
    const std::string path = element("dem.particles", i);
    if (!group.sizes && group.radius_max < group.radius_min)
      fail(origin, path + ".radius",
           "the largest radius of " + text(group.radius_max) + " m is below the smallest of " +
               text(group.radius_min) + " m",
           "give the smaller first");
    if (const auto* fill = std::get_if<LatticeFill>(&group.fill))
      validate_lattice(group, *fill, dem.domain, origin, path + ".fill");
    if (const auto* fill = std::get_if<InletFill>(&group.fill))
      validate_inlet(group, *fill, dem, origin, path + ".fill");
  }
}

void validate_outlets(const Dem& dem, const std::string& origin) {
  for (std::size_t i = 0; i < dem.outlets.size(); ++i) {
    const std::string path = element("dem.outlets", i) + ".region";
    const Outlet& outlet = dem.outlets[i];
    require_region(outlet, origin, path);
    if (!overlap(dem.domain, outlet).some)
      fail(origin, path, "it does not intersect dem.domain, so that no sphere can leave through it",
           "move it into the domain; what leaves that counts as lost");
    for (std::size_t k = 0; k < dem.particles.size(); ++k) {
      const auto* inlet = std::get_if<InletFill>(&dem.particles[k].fill);
      if (inlet != nullptr && overlap({inlet->min, inlet->max}, outlet).all)
        fail(origin, path,
             "all of the inlet " + element("dem.particles", k) +
                 " is in it: what comes in goes out a window later",
             "move one of the two");
    }
  }
}

void validate_law(const Dem& dem, const std::string& origin) {
  if (dem.contact == ContactLaw::hertz_frictionless && (dem.rolling || dem.twisting))
    fail(origin, dem.rolling ? "dem.rolling" : "dem.twisting", "spheres of 'hertz_frictionless' do not turn",
         "choose a contact law with friction, or \"none\"");
  if (dem.contact == ContactLaw::paper && dem.twisting)
    fail(origin, "dem.twisting",
         "contacts of 'paper' have no tangential stiffness before they slide, which twisting needs",
         "choose another contact law, or \"none\"");
}

void validate_micro_step(const Dem& dem, double window, const std::string& origin) {
  if (!dem.micro_step) return;
  const std::string path = "dem.micro_step", step = "the micro step of " + text(*dem.micro_step) + " s";
  if (*dem.micro_step > window)
    fail(origin, path, step + " is longer than the window of " + text(window) + " s",
         "a window holds whole steps");
}

}  // namespace

void validate_dem(const Dem& dem, double window, const std::string& origin) {
  require_box(dem.domain.min, dem.domain.max, origin, "dem.domain");
  validate_groups(dem, origin);
  validate_outlets(dem, origin);
  validate_law(dem, origin);
  validate_pairs(dem, origin);
  validate_micro_step(dem, window, origin);
}

}  // namespace tandem::scene
