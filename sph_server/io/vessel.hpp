// The vessel of a liquid: the body whose walls hold it, relative to which speeds are measured.
#pragma once

#include "common/scene/model.hpp"
#include "sph_server/io/body_walls.hpp"
#include "sph_server/io/fill.hpp"

namespace tandem::sph {

// Of the liquid at the start: the body, or the ground, that has most of it inside its walls or beside them.
// Without liquid at the start the only body with walls, where there is one. `poses`: of setup.walls, which
// begin with `walls`.
BodyId vessel_of(const scene::Scene& scene, const std::vector<BodyWalls>& walls, const LiquidSetup& setup,
                 const std::vector<particles::BodyPose>& poses, const Sites& sites,
                 const std::vector<FilledInside>& insides);

// Place of the vessel in the walls of the engine, and the middle of its walls. None for the ground.
std::optional<Vessel> vessel_in(const std::vector<BodyWalls>& walls, BodyId body);

}  // namespace tandem::sph
