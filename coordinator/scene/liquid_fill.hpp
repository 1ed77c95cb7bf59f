// The liquid inside walls is placed before the start, as beds of spheres are.
#pragma once

#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {

// Adds the places of particles that have to be relaxed to the files that the solver of the liquid receives,
// by sph::place_of_fill(): taken from the cache, or computed on `on` in this process. While that takes long,
// the log says how far it is. Other fills are left to the solver, which places them at once.
// Error{interrupted} within a second after Ctrl-C or SIGTERM. Error{scene} as the solver would give it,
// Error{resource} where the memory does not suffice.
void fill_liquids(SceneFile& file, const SettleOn& on);

}  // namespace tandem::launch
