// Refuses a start in which a wall is inside the liquid or passes through it or through an inlet.
#pragma once

#include <span>
#include <string>

#include "particles/geometry/path.hpp"
#include "sph_server/io/body_walls.hpp"
#include "sph_server/io/fill.hpp"
#include "sph_server/io/inlets.hpp"

namespace tandem::sph {

// A particle fills half a spacing around its centre; walls may be nearer by this share, since faces of round
// shapes and edges of meshes are not on the lattice.
inline constexpr double nearest_wall = 0.3;  // [spacings]

// `poses`: of the bodies at the start, then of the inlets. Error{scene} with the name of the wall or inlet
// for a site that is too near to it, and for a box through which it passes.
void check_start(const Sites& sites, const scene::Scene& scene, const std::vector<BodyWalls>& walls,
                 const std::vector<Inlet>& inlets, std::span<const particles::BodyPose> poses);

// Error{scene} for an inlet with a wall between the middle of its first layer and one of the particles of
// this layer, which the wall would cut off, for two inlets whose particles come in at one place, and for an
// inlet with liquid of `insides` on both sides and no wall between. up: against gravity.
void check_inlets(const std::vector<Inlet>& inlets, const std::vector<BodyWalls>& walls,
                  std::span<const particles::BodyPose> poses, double spacing,
                  const std::vector<FilledInside>& insides, Vec3d up);

}  // namespace tandem::sph
