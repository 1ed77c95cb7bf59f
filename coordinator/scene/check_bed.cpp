#include "coordinator/scene/check_bed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/sizes.hpp"
#include "coordinator/scene/scene_spheres.hpp"

namespace tandem::launch {
namespace {

constexpr double rounding = 1e-9;  // relative; radii and masses are sums and products of the same numbers

bool is_near(double a, double b) {
  return std::abs(a - b) <= rounding * std::abs(b);
}

std::string problem_of_radii(const std::vector<double>& radii, const scene::ParticleGroup& group,
                             std::size_t index, const particles::Fill& known) {
  std::vector<double> expected;
  for (std::size_t i = 0; i < known.radius.size(); ++i)
    if (known.group[i] == index) expected.push_back(known.radius[i]);
  if (!expected.empty())
    return radii == expected ? "" : fmt::format("its group '{}' has other radii than the scene", group.name);
  for (const double radius : radii)
    if (!(radius >= group.radius_min * (1 - rounding) && radius <= group.radius_max * (1 + rounding)))
      return fmt::format(
          "its group '{}' has a sphere with the radius {:.6g} m, and the scene gives {:.6g} to "
          "{:.6g} m",
          group.name, radius, group.radius_min, group.radius_max);
  return {};
}

std::string problem_of_amount(const std::vector<double>& radii, const scene::ParticleGroup& group,
                              double density) {
  const auto* packing = std::get_if<scene::PackingFill>(&group.fill);
  if (packing == nullptr) return {};
  if (packing->count && *packing->count != radii.size())
    return fmt::format("its group '{}' has {} spheres, and the scene {}", group.name, radii.size(),
                       *packing->count);
  const double mass = density * scene::volume_of(radii);
  if (packing->mass && !(std::abs(mass - *packing->mass) <= sphere_mass(density, group.radius_max)))
    return fmt::format("its group '{}' has a mass of {:.6g} kg, and the scene gives {:.6g} kg", group.name,
                       mass, *packing->mass);
  return {};
}

// Adds the kinetic energy of the spheres to `energy` [J].
std::string problem_of_motion(const scene::ParticleFile& spheres, const scene::Box& domain, double density,
                              double& energy) {
  for (std::size_t i = 0; i < spheres.positions.size(); ++i) {
    const Vec3d &x = spheres.positions[i], &v = spheres.velocities[i], &w = spheres.spins[i];
    bool inside = is_finite(x) && is_finite(v) && is_finite(w);
    for (int a = 0; inside && a < 3; ++a) inside = x[a] >= domain.min[a] && x[a] <= domain.max[a];
    if (!inside) return fmt::format("its sphere {} is not in the domain", i);
    const double r = spheres.radii[i];
    energy += 0.5 * sphere_mass(density, r) * (norm2(v) + 0.4 * r * r * norm2(w));
  }
  return {};
}

std::string problem_of_placed(const PlacedGroup& placed, const std::vector<double>& radii, double density) {
  const bool right = placed.spheres == radii.size() &&
                     is_near(placed.smallest, *std::ranges::min_element(radii)) &&
                     is_near(placed.largest, *std::ranges::max_element(radii)) &&
                     is_near(placed.mass, density * scene::volume_of(radii));
  return right ? "" : fmt::format("its figures of the group '{}' are not those of its spheres", placed.group);
}

}  // namespace

std::string problem_of(const CachedBed& bed, const scene::Scene& scene, const particles::Fill& known) {
  const scene::Dem& dem = scene.dem.value();
  std::vector<std::size_t> moving;  // indices of groups
  for (std::size_t i = 0; i < dem.particles.size(); ++i)
    if (!dem.particles[i].fixed && !std::holds_alternative<scene::InletFill>(dem.particles[i].fill))
      moving.push_back(i);
  const Settled& settled = bed.settled;
  if (settled.groups.size() != moving.size() || settled.spheres.size() != moving.size())
    return fmt::format("it has {} groups, and the scene {}", settled.groups.size(), moving.size());
  double energy = 0;
  std::size_t spheres = 0;
  for (std::size_t g = 0; g < moving.size(); ++g) {
    const scene::ParticleGroup& group = dem.particles[moving[g]];
    const scene::ParticleFile& of_bed = settled.spheres[g];
    const double density = dem.materials[group.material.value].density;
    if (settled.groups[g] != group.name) return fmt::format("it lacks the group '{}'", group.name);
    if (const std::string problem = problem_of_radii(of_bed.radii, group, moving[g], known); !problem.empty())
      return problem;
    if (const std::string problem = problem_of_amount(of_bed.radii, group, density); !problem.empty())
      return problem;
    if (const std::string problem = problem_of_motion(of_bed, dem.domain, density, energy); !problem.empty())
      return problem;
    for (const PlacedGroup& placed : bed.placed)
      if (placed.group == group.name)
        if (const std::string problem = problem_of_placed(placed, of_bed.radii, density); !problem.empty())
          return problem;
    spheres += of_bed.radii.size();
  }
  const double mean = energy / static_cast<double>(spheres);
  // Velocities of frames are single precision.
  if (!(mean <= dem.settle->kinetic_energy * 1.00001))
    return fmt::format("its mean kinetic energy is {:.4g} J, and the scene wants a bed below {:.4g} J", mean,
                       dem.settle->kinetic_energy);
  return {};
}

}  // namespace tandem::launch
