// The walls of a scene as one mesh for each body.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"

namespace tandem::sph {

struct BodyWalls {
  BodyId body;
  TriangleMesh mesh;                // of all walls of the body, in its frame; a plane is a square
  std::vector<std::string> inside;  // sentences: walls that are inscribed into round surfaces
};
// The bodies with walls in ascending order, the ground last. `meshes`: of the walls with a mesh, by name.
// Error{protocol} where one is missing.
std::vector<BodyWalls> walls_of_bodies(const scene::Scene& scene, const std::vector<NamedMesh>& meshes);

}  // namespace tandem::sph
