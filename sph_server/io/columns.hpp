// How much liquid is above the sites of boxes: their pressure at the start.
#pragma once

#include <vector>

#include "sph_server/io/fill.hpp"

namespace tandem::sph {

// Sets `above` and `depth` of the sites. A column of liquid ends at the surface or at a wall. What ends below
// a wall is covered, and has the surface of the liquid that it is connected to without a wall between.
// Between surfaces of several heights the height is the solution of the equation of Laplace, as the pressure
// is in an incompressible liquid at rest. Covered liquid without a connection is full up to its highest
// column. `poses`: of setup.walls.
void measure_columns(const scene::Scene& scene, const LiquidSetup& setup,
                     const std::vector<particles::BodyPose>& poses, const std::vector<FilledInside>& insides,
                     Sites& sites);

}  // namespace tandem::sph
