#include "particles/io/fill.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/scene/lattice.hpp"
#include "particles/io/random.hpp"

namespace tandem::particles {
namespace {

[[noreturn]] void fail(std::size_t index, const scene::ParticleGroup& group, const std::string& problem,
                       const std::string& hint) {
  throw Error(ErrorCode::scene, problem, "dem.particles[" + std::to_string(index) + "] '" + group.name + "'",
              hint);
}

void reserve_more(Fill& fill, std::size_t spheres) {
  const std::size_t n = fill.position.size() + spheres;
  fill.position.reserve(n);
  fill.velocity.reserve(n);
  fill.spin.reserve(n);
  fill.radius.reserve(n);
  fill.material.reserve(n);
  fill.group.reserve(n);
}
void append(Fill& fill, const scene::ParticleGroup& group, std::size_t index, Vec3d position, double radius,
            Vec3d velocity, Vec3d spin = {}) {
  fill.position.push_back(position);
  fill.velocity.push_back(velocity);
  fill.spin.push_back(spin);
  fill.radius.push_back(radius);
  fill.material.push_back(group.material.value);
  fill.group.push_back(static_cast<std::uint32_t>(index));
}

void add_lattice(Fill& fill, const scene::ParticleGroup& group, std::size_t index,
                 const scene::LatticeFill& lattice) {
  const double largest = group.radius_max, gap = lattice.spacing - 2 * largest;
  if (!(group.radius_min > 0)) fail(index, group, "the group gives no radius", "add radius [m]");
  // Checked here as well as by the scene, because a negative gap would turn jitter into overlaps.
  if (gap < 0) fail(index, group, "the spacing is less than the largest diameter", "enlarge spacing");
  const double capacity = scene::lattice_capacity(lattice, largest);
  const double wanted = lattice.count ? static_cast<double>(*lattice.count) : capacity;
  if (capacity < 1) fail(index, group, "the box holds no sphere", "enlarge the box");
  if (wanted > capacity) {
    fail(index, group,
         std::to_string(*lattice.count) + " spheres do not fit: the lattice has " +
             std::to_string(static_cast<std::uint64_t>(capacity)) + " sites",
         "enlarge the box, or reduce count or spacing");
  }
  if (wanted > 2147483647.0) fail(index, group, "more than 2147483647 spheres", "give a count");

  Random random(lattice.seed);
  const double most = lattice.jitter * gap / 2 / (lattice.lattice == "hexagonal" ? std::sqrt(3.0) : 1.0);
  reserve_more(fill, static_cast<std::size_t>(wanted));
  for (const Vec3d& site : scene::lattice_sites(lattice, largest, static_cast<std::uint64_t>(wanted))) {
    Vec3d p = site;
    for (int a = 0; a < 3; ++a) {
      // A site may be outside the box of centres by rounding.
      const double low = std::min(site[a], std::max(site[a] - most, lattice.min[a] + largest));
      const double high = std::max(site[a], std::min(site[a] + most, lattice.max[a] - largest));
      p[a] = random.uniform(low, high);
    }
    append(fill, group, index, p, random.uniform(group.radius_min, group.radius_max), group.velocity);
  }
}

void add_file(Fill& fill, const scene::ParticleGroup& group, std::size_t index,
              const std::vector<NamedParticles>& files, double overlap_limit) {
  const auto named =
      std::find_if(files.begin(), files.end(), [&](const auto& f) { return f.group == group.name; });
  if (named == files.end()) {
    fail(index, group, "no particle file came with the scene for this group",
         "the coordinator sends one for each group with a file");
  }
  const scene::ParticleFile& file = named->file;
  const bool radii = !file.radii.empty(), velocities = !file.velocities.empty(), spins = !file.spins.empty();
  if (group.fixed && (velocities || spins))
    fail(index, group, "the spheres of a fixed group never move, and its file gives velocities",
         "leave out its columns vx,vy,vz and wx,wy,wz, or fixed");
  if (!radii && !(group.radius_min > 0)) {
    fail(index, group, "neither the group nor its file gives a radius", "add radius [m]");
  }
  if ((radii && file.radii.size() != file.positions.size()) ||
      (velocities && file.velocities.size() != file.positions.size()) ||
      (spins && file.spins.size() != file.positions.size())) {
    fail(index, group, "the columns of the particle file differ in length", "send the file again");
  }
  reserve_more(fill, file.positions.size());
  if (spins) fill.accepted_overlap[index] = std::max(start_overlap_limit, overlap_limit);
  Random random(1);  // a file has no seed; used where radius is a range
  for (std::size_t i = 0; i < file.positions.size(); ++i) {
    const double radius = radii ? file.radii[i] : random.uniform(group.radius_min, group.radius_max);
    append(fill, group, index, file.positions[i], radius, velocities ? file.velocities[i] : group.velocity,
           spins ? file.spins[i] : Vec3d{});
  }
}

// The groups that are fixed, or the others.
Fill make_groups(const scene::Scene& scene, const std::vector<NamedParticles>& files, bool fixed) {
  Fill fill;
  const auto& groups = scene.dem.value().particles;
  if (scene.dem->settle)
    throw Error(ErrorCode::scene, "the bed has not settled yet, which this program does not do", "dem.settle",
                "send the scene in the plain form, as tandem does");
  fill.accepted_overlap.assign(groups.size(), start_overlap_limit);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i].fixed != fixed) continue;
    if (const auto* lattice = std::get_if<scene::LatticeFill>(&groups[i].fill)) {
      add_lattice(fill, groups[i], i, *lattice);
    } else if (std::holds_alternative<scene::FileFill>(groups[i].fill)) {
      add_file(fill, groups[i], i, files, scene.dem->overlap_limit);
    } else if (!std::holds_alternative<scene::InletFill>(groups[i].fill)) {
      fail(i, groups[i], "the spheres of its fill are not placed yet, which this program does not do",
           "send the scene in the plain form, as tandem does");
    }
  }
  return fill;
}

}  // namespace

Fill make_fill(const scene::Scene& scene, const std::vector<NamedParticles>& files) {
  return make_groups(scene, files, false);
}

std::vector<FixedSphere> make_fixed(const scene::Scene& scene, const std::vector<NamedParticles>& files) {
  const Fill fill = make_groups(scene, files, true);
  std::vector<FixedSphere> fixed;
  for (std::size_t i = 0; i < fill.position.size(); ++i) {
    if (!is_finite(fill.position[i]) || !(fill.radius[i] > 0) || !std::isfinite(fill.radius[i]))
      fail(fill.group[i], scene.dem->particles[fill.group[i]],
           "sphere " + std::to_string(fixed.size()) +
               " of the fixed ones has a radius or position that is no number",
           "check its line");
    fixed.push_back({fill.position[i], fill.radius[i], fill.material[i], fill.group[i]});
  }
  return fixed;
}

}  // namespace tandem::particles
