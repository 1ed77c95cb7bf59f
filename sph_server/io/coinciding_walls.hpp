// Refuses walls that lie on each other in front of the liquid.
#pragma once

#include <vector>

#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/io/body_walls.hpp"
#include "sph_server/io/inlets.hpp"

namespace tandem::sph {

// Two facets in one plane would both act where they overlap, unless other walls hide that from the liquid.
// Error{scene} where a particle, or one of the first layer of an inlet, sees such an overlap at the start.
// `walls`, then the pistons of the inlets, are those of `setup`, which have these poses.
void refuse_coinciding_walls(const std::vector<Vec3d>& particles, const std::vector<BodyWalls>& walls,
                             const std::vector<Inlet>& inlets, const LiquidSetup& setup,
                             const std::vector<particles::BodyPose>& poses, const scene::Scene& scene);

}  // namespace tandem::sph
