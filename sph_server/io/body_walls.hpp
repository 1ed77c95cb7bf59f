// The walls of a scene as meshes.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"

namespace tandem::sph {

// Walls whose loads the solver keeps apart from others: those of one body, without each wall that a sensor of
// a load names and without the area of each sensor of pressure, which are for themselves.
struct BodyWalls {
  BodyId body;
  std::string sensed;             // name of the wall that is for itself; empty: all others of the body
  std::string patch;              // name of the sensor of pressure whose area this part of the walls is
  TriangleMesh mesh;              // in the frame of the body; a plane is a square
  std::vector<std::string> wall;  // name of the wall of each triangle
  std::vector<std::string> approximations;  // sentences: walls that stand for round surfaces
};
// By body in ascending order, the ground last; of each body first the walls that are for themselves, by name.
// `meshes`: of the walls with a mesh, by name. Error{protocol} where one is missing, Error{scene} for a mesh
// with two triangles at one place, and for an area without a wall.
std::vector<BodyWalls> walls_of_bodies(const scene::Scene& scene, const std::vector<NamedMesh>& meshes);

// Whether all walls of a body have friction or none has.
bool is_slip(const scene::Sph& sph, BodyId body);

// The whole surface of a wall, with the faces that it leaves open, in the frame of its body. The wall is no
// plane.
TriangleMesh whole_mesh_of(const scene::Wall& wall, const scene::Sph& sph,
                           const std::vector<NamedMesh>& meshes);

// Do the normals of a closed mesh point inwards?
bool is_inside_out(const TriangleMesh& mesh);
void turn_over(TriangleMesh& mesh);

}  // namespace tandem::sph
