#include "coordinator/scene/scene_spheres.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "dem_server/laws/step_limits.hpp"
#include "particles/io/inlets.hpp"

namespace tandem::launch {

double sphere_mass(double density, double radius) {
  return density * 4 / 3 * std::numbers::pi * radius * radius * radius;
}

const SceneSpheres::Group& SceneSpheres::group_of(std::uint32_t id) const {
  return *std::ranges::upper_bound(groups, id, {}, &Group::end);
}

std::vector<std::uint32_t> SceneSpheres::group_by_id() const {
  std::vector<std::uint32_t> of_sphere;
  of_sphere.reserve(in_all);
  for (const Group& group : groups) of_sphere.resize(group.end, group.index);
  return of_sphere;
}

std::vector<particles::NamedParticles> particles_in(const SceneFile& file) {
  std::vector<particles::NamedParticles> read;
  for (const protocol::NamedText& text : file.files)
    read.push_back({text.name, scene::read_particle_file(text.text, text.name)});
  return read;
}

SceneSpheres spheres_of(const SceneFile& file) {
  const scene::Dem& of_scene = file.scene.dem.value();
  SceneSpheres all;
  particles::Fill fill = particles::make_fill(file.scene, particles_in(file));
  all.at_start = fill.radius.size();
  all.start = fill;
  particles::append_waiting(particles::make_inlets(file.scene), file.scene, fill);
  all.in_all = fill.radius.size();

  // Smallest radius of each material.
  std::map<std::uint32_t, double> smallest;
  for (std::size_t i = 0; i < fill.radius.size();) {
    const std::uint32_t index = fill.group[i];
    const scene::ParticleGroup& given = of_scene.particles[index];
    SceneSpheres::Group& group = all.groups.emplace_back();
    group.name = given.name;
    group.index = index;
    group.density = of_scene.materials[fill.material[i]].density;
    const bool random = given.radius_min > 0 && given.radius_min < given.radius_max;
    group.smallest = given.radius_min > 0 ? given.radius_min : fill.radius[i];
    group.largest = given.radius_max;
    if (const auto* lattice = std::get_if<scene::LatticeFill>(&given.fill))
      group.place_tolerance = lattice->jitter * (lattice->spacing - 2 * given.radius_max);
    for (; i < fill.radius.size() && fill.group[i] == index; ++i) {
      const double radius = fill.radius[i], mass = sphere_mass(group.density, radius);
      group.smallest = std::min(group.smallest, radius);
      group.largest = std::max(group.largest, radius);
      const auto [known, is_new] = smallest.emplace(fill.material[i], radius);
      if (!is_new) known->second = std::min(known->second, radius);
      if (i >= all.at_start) continue;
      const double spread = random ? std::max(sphere_mass(group.density, given.radius_max) - mass,
                                              mass - sphere_mass(group.density, given.radius_min))
                                   : 0;
      all.mass += mass;
      all.mass_spread += spread;
      all.momentum += mass * fill.velocity[i];
      all.momentum_size += mass * norm(fill.velocity[i]);
      all.momentum_spread += spread * norm(fill.velocity[i]);
    }
    group.end = static_cast<std::uint32_t>(i);
  }
  all.critical_time = std::numeric_limits<double>::infinity();
  for (const auto& [material, radius] : smallest)
    all.critical_time =
        std::fmin(all.critical_time, dem::critical_time(of_scene, MaterialId{material}, radius));
  return all;
}

}  // namespace tandem::launch
