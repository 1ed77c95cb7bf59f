// What a scene says of its spheres: how many there are, where and how heavy.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coordinator/scene/scene_file.hpp"
#include "particles/io/fill.hpp"

namespace tandem::launch {

struct SceneSpheres {
  // Spheres of consecutive ids.
  struct Group {
    std::string name;
    std::uint32_t end = 0;             // id after the last one
    double density = 0;                // [kg/m3]
    double smallest = 0, largest = 0;  // radius that a sphere of the group may have [m]
    double place_tolerance = 0;        // of the place at the start, where it is random [m]
    std::uint32_t index = 0;           // in dem.particles
  };
  std::vector<Group> groups;
  std::uint64_t at_start = 0, in_all = 0;  // without and with those that inlets bring
  // Of the spheres at the start. Where radii are random, other spheres of the scene may differ by the spread.
  double mass = 0, mass_spread = 0;               // [kg]
  Vec3d momentum;                                 // [kg m/s]
  double momentum_size = 0, momentum_spread = 0;  // sum of m |v| [kg m/s]
  double critical_time = 0;                       // the shortest of all spheres, infinite without one [s]
  particles::Fill start;                          // of the spheres at the start

  const Group& group_of(std::uint32_t id) const;   // id < in_all
  std::vector<std::uint32_t> group_by_id() const;  // index in dem.particles of each sphere
};

double sphere_mass(double density, double radius);

// The particle files of the scene.
std::vector<particles::NamedParticles> particles_in(const SceneFile& file);

// Throws the errors of particles::make_fill().
SceneSpheres spheres_of(const SceneFile& file);

}  // namespace tandem::launch
