// Faces of walls through which the liquid inside them flows out at the start.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sph_server/io/body_walls.hpp"
#include "sph_server/io/fill.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {

struct OpenFace {
  std::string face;  // such as "+z"
  Vec3d at;          // [m]
};
// The first face that a box or a cylinder leaves open below a level along `up`, with a point of it to which
// no wall is nearer than half a spacing. `walls`: all, where they are at the start.
std::optional<OpenFace> open_face(const scene::Wall& wall, const scene::Scene& scene,
                                  const std::vector<NamedMesh>& meshes, const Walls& walls, Vec3d up,
                                  double level);

// A sentence for each filled box or cylinder that leaves a face open below the level, where no other wall
// closes it. `poses`: of the walls of `setup`.
std::vector<std::string> open_faces(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                                    const std::vector<FilledInside>& insides, const LiquidSetup& setup,
                                    const std::vector<particles::BodyPose>& poses);

}  // namespace tandem::sph
