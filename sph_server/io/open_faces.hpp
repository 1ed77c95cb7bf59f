// Faces of walls through which the liquid inside them flows out at the start.
#pragma once

#include <string>
#include <vector>

#include "sph_server/io/body_walls.hpp"
#include "sph_server/io/fill.hpp"

namespace tandem::sph {

// A sentence for each face that a filled box or cylinder leaves open below the level, where no other wall
// closes it. `poses`: of the walls of `setup`.
std::vector<std::string> open_faces(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                                    const std::vector<FilledInside>& insides, const LiquidSetup& setup,
                                    const std::vector<particles::BodyPose>& poses);

}  // namespace tandem::sph
