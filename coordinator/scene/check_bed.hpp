// Whether a bed from the cache can be one of this scene. The digest of a file shows damage, not intent, and
// the key of a bed is no secret.
#pragma once

#include <string>

#include "coordinator/scene/settle_cache.hpp"
#include "particles/io/fill.hpp"

namespace tandem::launch {

// Empty where the bed has the groups of the scene that move, with their radii, numbers and masses, in the
// domain and at rest; otherwise what it has instead. `known`: the spheres of the lattices and files, whose
// radii are known before anything is packed.
std::string problem_of(const CachedBed& bed, const scene::Scene& scene, const particles::Fill& known);

}  // namespace tandem::launch
