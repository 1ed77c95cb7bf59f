#include "dem_server/laws/step_limits.hpp"

#include <algorithm>
#include <limits>

#include "common/scene/fault.hpp"
#include "dem_server/laws/generic.hpp"

namespace tandem::dem {
namespace {

// Printed limits are rounded down, so that they can be copied.
constexpr double down = 1 - 5e-6;

// The least of f(law, pair, other material) over the contacts that spheres of the material can have.
template <class F>
double least_of_contacts(const scene::Dem& dem, MaterialId material, F f) {
  return with_law(dem.contact, [&](auto law) {
    double least = std::numeric_limits<double>::infinity();
    for (const scene::Pair& pair : dem.pairs)
      if (pair.a == material || pair.b == material)
        least = std::min(least, f(law, pair, dem.materials[(pair.a == material ? pair.b : pair.a).value]));
    return least;
  });
}

}  // namespace

double collision_time(const scene::Dem& dem, MaterialId material, double radius, double speed) {
  const scene::Material& own = dem.materials[material.value];
  return least_of_contacts(dem, material,
                           [&](auto law, const scene::Pair& pair, const scene::Material& other) {
                             return decltype(law)::collision_time(pair, own, other, radius, speed);
                           });
}

double critical_time(const scene::Dem& dem, MaterialId material, double radius) {
  const scene::Material& own = dem.materials[material.value];
  return least_of_contacts(dem, material, [&](auto law, const scene::Pair& pair, const scene::Material&) {
    return decltype(law)::critical_time(pair, own, radius);
  });
}

double critical_time(const scene::Dem& dem) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const scene::ParticleGroup& group : dem.particles)
    if (group.radius_min > 0 && !group.fixed)
      shortest = std::min(shortest, critical_time(dem, group.material, group.radius_min));
  return shortest;
}

void check_micro_step(const scene::Dem& dem, const std::string& origin) {
  if (!dem.micro_step) return;
  const double critical = critical_time(dem), limit = largest_step_share * critical;
  if (*dem.micro_step <= limit) return;
  const std::string name =
      with_law(dem.contact, [](auto law) -> std::string { return decltype(law)::critical_time_name; });
  scene::fail(origin, "dem.micro_step",
              "the micro step of " + scene::text(*dem.micro_step) + " s is above the stable " +
                  scene::rounded(down * limit) + " s, " + scene::text(largest_step_share) + " of the " +
                  name + " time",
              "leave it out for " + scene::rounded(automatic_step_share * critical) + " s");
}

void check_micro_step(const scene::Dem& dem, const std::string& origin, MaterialId material,
                      const std::vector<double>& radii, const std::string& file) {
  if (!dem.micro_step) return;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const double limit = largest_step_share * critical_time(dem, material, radii[i]);
    if (*dem.micro_step > limit)
      scene::fail(origin, "dem.micro_step",
                  "the micro step of " + scene::text(*dem.micro_step) + " s is above the stable " +
                      scene::rounded(down * limit) + " s of sphere " + std::to_string(i + 1) + " of " + file,
                  "leave it out to have it chosen");
  }
}

}  // namespace tandem::dem
