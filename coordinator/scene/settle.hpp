// The spheres of a scene come to rest before the start.
#pragma once

#include <string>
#include <vector>

#include "common/scene/particle_file.hpp"
#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {

struct Settled {
  std::vector<std::string> groups;           // names
  std::vector<scene::ParticleFile> spheres;  // of each group, with radius, velocity and spin
  double time = 0;                           // simulated [s]
  double kinetic_energy = 0;                 // mean of the spheres [J]
};

// The scene as the settling depends on it: bodies and walls at rest in their start poses, no inlets, no
// outlets, and none of what concerns the run alone. `text`: in the plain form.
std::string settling_scene(const std::string& text);

// Runs the particle solver in this process until the mean kinetic energy of the spheres has been below the
// bound for the time of a fall through the largest radius. All fills of `file` are placed. `settle` is that
// of the scene. Throws Error{scene} where the bound is too high to tell a bed from falling spheres, where
// spheres leave the domain, and where the time does not suffice.
Settled settle(const SceneFile& file, const scene::Settle& settle, const SettleOn& on);

}  // namespace tandem::launch
