#include <algorithm>
#include <cmath>

#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

// Share of a spacing by which the edge of a box may differ from a whole number of spacings.
constexpr double edge_tolerance = 1e-6;
// Particles have indices of 26 bits in the lists of neighbours.
constexpr double most_particles = (1 << 26) - 1;
// Liquid hydrogen has 71 kg/m3, liquid osmium 20,100 kg/m3.
constexpr double least_density = 50, largest_density = 25000;

void validate_density(double density, const std::string& origin, const std::string& path) {
  if (density >= least_density && density <= largest_density) return;
  const double from_grams = 1000 * density;  // of a value in g/cm3
  const bool grams = from_grams >= least_density && from_grams <= largest_density;
  fail(origin, path + ".density",
       "no liquid has a density of " + text(density) + " kg/m3; they are from " + text(least_density) +
           " to " + text(largest_density) + " kg/m3",
       grams ? "1 g/cm3 is 1000 kg/m3: give " + rounded(from_grams) : "water has 1000 kg/m3");
}

void validate_fill_of(const Box& box, const Sph& sph, const std::string& origin, const std::string& path) {
  require_box(box.min, box.max, origin, path);
  for (int axis = 0; axis < 3; ++axis) {
    const double edge = box.max[axis] - box.min[axis], count = edge / sph.spacing;
    if (std::round(count) < 1 || std::abs(count - std::round(count)) > edge_tolerance * std::fmax(1, count)) {
      const double fewer = std::fmax(1, std::floor(count));
      fail(origin, element(path + ".max", axis),
           "the box is " + text(edge) + " m wide along " + "xyz"[axis] + ", which is " + rounded(count) +
               " times sph.spacing",
           "particles are cubes of one spacing: give " + rounded(box.min[axis] + fewer * sph.spacing) +
               " or " + rounded(box.min[axis] + (fewer + 1) * sph.spacing) + ", or a spacing of " +
               rounded(edge / fewer));
    }
    const char* side = box.min[axis] < sph.domain.min[axis]   ? "min"
                       : box.max[axis] > sph.domain.max[axis] ? "max"
                                                              : nullptr;
    if (!side) continue;
    const bool low = side[1] == 'i';
    fail(origin, element(path + "." + side, axis),
         text((low ? box.min : box.max)[axis]) + " m is outside the domain, which ends at " +
             text((low ? sph.domain.min : sph.domain.max)[axis]) + " m",
         "enlarge sph.domain or move the fill");
  }
}

// Boxes that have more than a rounding in common.
bool overlap(const Box& a, const Box& b, double spacing) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::fmin(a.max[axis], b.max[axis]) - std::fmax(a.min[axis], b.min[axis]) <= edge_tolerance * spacing)
      return false;
  return true;
}

void validate_inside(const LiquidInside& fill, const Scene& scene, const std::string& origin,
                     const std::string& path) {
  const Wall& wall = require_wall(fill.wall, scene.sph->walls, origin, path + ".wall");
  if (std::holds_alternative<PlaneShape>(wall.shape))
    fail(origin, path + ".wall", "'" + fill.wall + "' is a plane, which has no inside",
         "name a wall that ends on all sides, or fill a box");
  if (norm(scene.gravity) == 0) fail(origin, path, "no level follows: there is no gravity", "fill a box");
  if (scene.sph->liquids.front().pressure == StartPressure::zero)
    fail(origin, path, "the liquid inside a wall is at rest under its own weight, and 'pressure' is zero",
         "leave out pressure, or fill a box");
}

double particles_in(const Box& box, double spacing) {
  double count = 1;
  for (int axis = 0; axis < 3; ++axis) count *= std::round((box.max[axis] - box.min[axis]) / spacing);
  return count;
}

// What a domain that follows a body requires.
void validate_moving_liquid(const Scene& scene, const std::string& origin) {
  const Sph& sph = *scene.sph;
  const BodyId followed = *sph.follows;
  const std::string path = "sph.domain.follows", name = "'" + scene.body_name(followed) + "'";
  if (std::ranges::any_of(sph.periodic, [](bool axis) { return axis; }))
    fail(origin, path, "a periodic domain cannot follow a body", "leave out periodic or follows");
  if (std::ranges::none_of(sph.walls, [&](const Wall& wall) { return wall.body == followed; }))
    fail(origin, path, "the body " + name + " carries no wall of the liquid",
         "the solver of the liquid knows where bodies with walls are: name one of those");
  if (!sph.inlets.empty())
    fail(origin, path, "inlets are on the ground, and the domain leaves it", "leave out inlets or follows");
  for (const Wall& wall : sph.walls)
    if (std::holds_alternative<PlaneShape>(wall.shape) && wall.body != followed)
      fail(origin, path,
           "the plane '" + wall.name + "' ends where the domain is at the start, and is not on " + name,
           "give it as a box or a mesh that reaches along the whole way, or leave out follows");
}

// The machine starts at rest under the weight of the liquid, which sph_server computes.
void validate_rest(const Scene& scene, const std::string& origin) {
  const Sph& sph = *scene.sph;
  const Liquid& liquid = sph.liquids.front();
  const auto moves = [](const Wall& wall) { return wall.body != ground; };
  if (!std::ranges::any_of(sph.walls, moves)) return;
  if (!sph.server.empty() && sph.server != "sph_server")
    fail(origin, "mbd.start",
         "the weight of the liquid on the machine is known to sph_server only, and '" + sph.server +
             "' computes it",
         "leave it out, and give the machine the position that it has with its liquid");
  if (liquid.velocity && norm(*liquid.velocity) > 0)
    fail(origin, element("sph.liquids", 0) + ".velocity",
         "the liquid moves at the start, and an equilibrium is at rest", "leave velocity out, or mbd.start");
  if (liquid.pressure != StartPressure::hydrostatic)
    fail(origin, element("sph.liquids", 0) + ".pressure",
         "the liquid starts without the pressure of its weight, and an equilibrium is at rest",
         "leave pressure out, or mbd.start");
}

}  // namespace

void validate_sph(const Scene& scene, const std::string& origin) {
  const Sph& sph = *scene.sph;
  require_box(sph.domain.min, sph.domain.max, origin, "sph.domain");
  if (sph.liquids.size() > 1)
    fail(origin, element("sph.liquids", 1),
         "'" + sph.liquids[1].name + "' is a second liquid, and the solver computes one",
         "leave one of them");
  if (sph.micro_step && *sph.micro_step > scene.coupling.window)
    fail(origin, "sph.micro_step",
         "the micro step of " + text(*sph.micro_step) + " s is longer than the window of " +
             text(scene.coupling.window) + " s",
         "a window holds whole steps");
  if (sph.follows) validate_moving_liquid(scene, origin);
  if (scene.mbd && scene.mbd->start == Start::equilibrium) validate_rest(scene, origin);
  const Liquid& liquid = sph.liquids.front();
  const std::string path = element("sph.liquids", 0);
  validate_density(liquid.density, origin, path);
  if (!liquid.sound_speed && liquid.expected_speed == 0 && norm(scene.gravity) == 0 && sph.inlets.empty())
    fail(origin, path, "no speed of sound follows: there is no gravity, and no speed is expected",
         "give expected_speed, the largest speed that the run will have [m/s], or sound_speed");
  validate_liquid_traffic(scene, origin);
  double count = 0;
  for (std::size_t i = 0; i < liquid.fill.size(); ++i) {
    const std::string of_fill = element(path + ".fill", i);
    const Box* box = std::get_if<Box>(&liquid.fill[i]);
    if (!box) {
      validate_inside(std::get<LiquidInside>(liquid.fill[i]), scene, origin, of_fill);
      continue;
    }
    validate_fill_of(*box, sph, origin, of_fill);
    for (std::size_t k = 0; k < i; ++k)
      if (const Box* other = std::get_if<Box>(&liquid.fill[k]); other && overlap(*box, *other, sph.spacing))
        fail(origin, of_fill, "the box overlaps " + element(path + ".fill", k),
             "the liquid would be there twice: let the boxes touch");
    count += particles_in(*box, sph.spacing);
  }
  for (std::size_t i = 0; i < sph.pairs.size(); ++i) {
    const BodyId body = sph.pairs[i].body;
    const std::string of_pair = element("sph.pairs", i);
    if (std::ranges::none_of(sph.walls, [&](const Wall& wall) { return wall.body == body; }))
      fail(origin, of_pair + ".body", "there is no wall of the liquid on '" + scene.body_name(body) + "'",
           "name a body that has one");
    for (std::size_t k = 0; k < i; ++k)
      if (sph.pairs[k].body == body)
        fail(origin, of_pair, "is the same pair as " + element("sph.pairs", k), "leave one of them out");
  }
  if (count > most_particles)
    fail(origin, "sph.spacing",
         "the liquid has " + rounded(count) + " particles, more than " + rounded(most_particles),
         "give a larger spacing");
}

}  // namespace tandem::scene
